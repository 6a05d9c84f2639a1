// A synthetic window for the tests of the optimiser: a camera on the closed-form motion, landmarks
// in front of it, and a pose graph filled by the operations that the front end uses, with estimates
// that are off by a known noise.
#pragma once

#include <algorithm>
#include <vector>

#include "sim/work/machine.h"
#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/graph/optimiser.h"

namespace leviosim::vio::test {

struct OptimiserSceneOptions {
  int keyframes = 8;
  int landmarks = 200;
  int shortest_track = 3, longest_track = 8;  ///< keyframes that see a landmark
  double longer_tracks = 0;                   ///< share of landmarks that one more sees
  double interval_s = 0.2;
  double rotation_noise = 0.02;  ///< rad, of all keyframes but the oldest
  double position_noise = 0.05;  ///< m
  double velocity_noise = 0.1;   ///< m/s
  double depth_noise = 0.1;   ///< of a landmark along its ray, relative to its depth; a fifth of it
                              ///< across
  double outliers = 0;        ///< share of observations that are 30 px off
  bool whole_pixels = false;  ///< otherwise 1/64 px
  std::uint64_t seed = 1;
};

/// Window, graph and truth.
template <class P>
struct OptimiserScene {
  using F = typename P::F32;
  using I32 = typename P::I32;

  struct Observation {
    int keyframe;
    Eigen::Vector2d pixel;
  };

  explicit OptimiserScene(const OptimiserSceneOptions& scene_options = {}, bool record = false)
      : scene(scene_options),
        fc(machine_config(record)),
        graph(fc.local(), GraphCapacity{}),
        window(fc.local(), GraphCapacity{}),
        random(scene_options.seed) {
    const double unit = scene.whole_pixels ? 1 : 64;
    PinholeCamera& camera = options.visual.camera;
    for (float* parameter :
         {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &options.visual.sigma_px,
          &options.visual.huber_px, &options.visual.lost_px})
      *parameter *= static_cast<float>(unit);
    make_landmarks();
    fill_graph();
    take_snapshot<P>(graph, ImuNoise{}, fc.local(), window);
  }

  static work::MachineConfig machine_config(bool record) {
    work::MachineConfig config;
    config.cores = 1;
    config.memory = "L2";
    config.capacity = Bytes(1'600'000);
    config.record = record;
    return config;
  }

  double time(int k) const { return scene.interval_s * k; }
  Eigen::Vector2d project(const Vector3d& in_camera) const {
    const PinholeCamera& c = options.visual.camera;
    return {static_cast<double>(c.fx) * in_camera.x() / in_camera.z() + static_cast<double>(c.cx),
            static_cast<double>(c.fy) * in_camera.y() / in_camera.z() + static_cast<double>(c.cy)};
  }
  Vector3d in_camera(int k, const Vector3d& point) const {
    return Motion::rotation(time(k)).transpose() * (point - Motion::position(time(k)));
  }
  bool visible(const Vector3d& x) const {
    if (x.z() < 0.5) return false;
    const Eigen::Vector2d pixel = project(x);
    const double unit = scene.whole_pixels ? 1 : 64;
    return pixel.x() > 0 && pixel.y() > 0 && pixel.x() < 159 * unit && pixel.y() < 119 * unit;
  }

  void make_landmarks() {
    while (static_cast<int>(points.size()) < scene.landmarks) {
      const int drawn =
          static_cast<int>(random.uniform(scene.shortest_track, scene.longest_track + 0.999));
      const bool longer = scene.longer_tracks > 0 && random.uniform(0, 1) < scene.longer_tracks;
      const int length = std::min(scene.keyframes, drawn + (longer ? 1 : 0));
      const int first = static_cast<int>(random.uniform(0, scene.keyframes - length + 0.999));
      const double depth = random.uniform(1.5, 6.0);
      const double x = random.uniform(-0.65, 0.65), y = random.uniform(-0.5, 0.5);
      const Vector3d point = Motion::rotation(time(first)) * Vector3d(x * depth, y * depth, depth) +
                             Motion::position(time(first));
      std::vector<Observation> seen;
      for (int k = first; k < first + length; ++k)
        if (visible(in_camera(k, point))) seen.push_back({k, project(in_camera(k, point))});
      if (static_cast<int>(seen.size()) < length) continue;
      for (Observation& o : seen)
        if (random.uniform(0, 1) < scene.outliers) {
          const double angle = random.uniform(0, 2 * M_PI);
          o.pixel += 30 * (scene.whole_pixels ? 1 : 64) *
                     Eigen::Vector2d(std::cos(angle), std::sin(angle));
        }
      points.push_back(point);
      tracks.push_back(seen);
    }
  }

  KeyframeState<P> estimate(int k) {
    KeyframeState<P> state = motion.template state<P>(time(k));
    if (k == 0) return state;
    const double t = time(k);
    state.T_world_camera.R =
        to_mat3<P>(Motion::rotation(t) * exp_of(scene.rotation_noise * random.normal3()));
    state.T_world_camera.t =
        to_vec3<P>(Motion::position(t) + scene.position_noise * random.normal3());
    state.velocity = to_vec3<P>(Motion::velocity(t) + scene.velocity_noise * random.normal3());
    return state;
  }

  void fill_graph() {
    graph.clear(ImuBias<P>::zero(), to_vec3<P>(motion.gravity));
    const OwnedInterval<P> interval;
    for (int k = 0; k < scene.keyframes; ++k) {
      if (k == 0)
        interval.reset(ImuBias<P>::zero());
      else
        integrate<P>(motion, time(k - 1), time(k), 40, interval, ImuBias<P>::zero());
      graph.add_keyframe(estimate(k), interval.record());
      graph.age_landmarks();
    }
    const std::vector<typename P::U32> no_descriptor(8);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d& point = points[i];
      const Vector3d ray = point - Motion::position(time(tracks[i][0].keyframe));
      const double along = random.normal();
      const Vector3d off = scene.depth_noise * (ray * along + 0.2 * ray.norm() * random.normal3());
      const I32 slot = graph.add_landmark(to_vec3<P>(point + off), no_descriptor);
      for (const Observation& o : tracks[i])
        graph.add_observation(o.keyframe, slot,
                              std::max(0, static_cast<int>(std::lround(o.pixel.x()))),
                              std::max(0, static_cast<int>(std::lround(o.pixel.y()))));
    }
  }

  /// Iterates up to `iterations` times.
  std::vector<IterationReport> optimise(int iterations) {
    std::vector<IterationReport> reports;
    LmState<P> lm(options);
    for (int i = 0; i < iterations; ++i) {
      const auto stage = fc.stage("optimiser");
      reports.push_back(optimise_once<P>(fc, window, lm, options));
    }
    return reports;
  }

  double position_error(int k) const {
    return (to_eigen<P>(window.state.pose(k).t) - Motion::position(time(k))).norm();
  }
  double rotation_error(int k) const {
    return log_of(Motion::rotation(time(k)).transpose() * to_eigen<P>(window.state.pose(k).R))
        .norm();
  }
  double velocity_error(int k) const {
    return (to_eigen<P>(window.state.keyframe(k).velocity) - Motion::velocity(time(k))).norm();
  }
  /// Root mean square over keyframes.
  template <class Error>
  double rms(Error error) const {
    double sum = 0;
    for (int k = 0; k < scene.keyframes; ++k) sum += error(k) * error(k);
    return std::sqrt(sum / scene.keyframes);
  }
  double position_rms() const {
    return rms([this](int k) { return position_error(k); });
  }
  double rotation_rms() const {
    return rms([this](int k) { return rotation_error(k); });
  }
  double velocity_rms() const {
    return rms([this](int k) { return velocity_error(k); });
  }
  /// Median distance of the landmarks from the truth.
  double point_median() const {
    std::vector<double> errors;
    for (int i = 0; i < window.landmarks; ++i) {
      const auto slot = static_cast<std::size_t>(work::value(I32(window.landmark_slots[i])));
      errors.push_back(
          (to_eigen<P>(load_vec3<P>(window.state.points, 3 * i)) - points[slot]).norm());
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2),
                     errors.end());
    return errors[errors.size() / 2];
  }

  OptimiserSceneOptions scene;
  Motion motion;
  OptimiserOptions options;
  work::Machine fc;
  PoseGraph<P> graph;
  Window<P> window;
  TestRandom random;
  std::vector<Vector3d> points;                  ///< by landmark slot
  std::vector<std::vector<Observation>> tracks;  ///< by landmark slot
};

}  // namespace leviosim::vio::test
