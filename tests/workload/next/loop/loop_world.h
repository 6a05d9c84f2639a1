// Worlds of points with descriptors, flights through them, and an odometry that drifts: what loop
// closure is fed without images.
//
// A hall's walls are panels of 2 m. A texture is a pattern of points on a panel, with relief; a
// hall has as many textures as it is told, so that few of them repeat, or one for every panel. A
// camera sees the points in front of it that face it, with noise of the pixel, flipped bits, points
// that no corner is found at, and corners that show nothing.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/work/machine.h"
#include "tests/workload/levio/epnp_scene.h"
#include "workload/next/loop/loop_closer.h"

namespace leviosim::vio::test {

using Descriptor = std::array<std::uint32_t, 8>;

inline Descriptor random_descriptor(Random& random) {
  Descriptor words;
  for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random.next());
  return words;
}

inline Descriptor with_flipped_bits(Descriptor words, Random& random, double share) {
  for (int bit = 0; bit < 256; ++bit)
    if (random.uniform(0, 1) < share) words[static_cast<std::size_t>(bit / 32)] ^= 1u << (bit % 32);
  return words;
}

struct WorldPoint {
  Eigen::Vector3d position;
  Eigen::Vector3d facing;  ///< of the surface
  Descriptor descriptor;
};

/// Along x from 0 to length, along y from 0 to width, 4 m high.
struct HallOptions {
  double length = 16, width = 10;
  Eigen::Vector2d shift{0, 0};  ///< of its walls against the path
  int textures = 0;             ///< that the panels choose from; 0: each has its own
  std::uint64_t seed = 1;
  std::uint64_t texture_seed = 1;
};

inline std::vector<WorldPoint> make_panels(const HallOptions& hall) {
  constexpr double kPanel = 2, kPanelHeight = 4;
  constexpr int kPoints = 72;
  using Texture = std::vector<WorldPoint>;  // x along the wall, y away from it, z up
  Random paint(hall.texture_seed), choice(hall.seed * 7919 + 13);
  const auto make_texture = [&] {
    Texture texture;
    for (int i = 0; i < kPoints; ++i)
      texture.push_back(
          {{paint.uniform(0, kPanel), paint.uniform(0, 0.5), paint.uniform(0, kPanelHeight)},
           Eigen::Vector3d::UnitY(),
           random_descriptor(paint)});
    return texture;
  };
  std::vector<Texture> textures;
  for (int i = 0; i < hall.textures; ++i) textures.push_back(make_texture());
  std::vector<WorldPoint> points;
  const auto wall = [&](const Eigen::Vector3d& from, double length, double turn) {
    const Eigen::Vector3d corner = from + Eigen::Vector3d(hall.shift.x(), hall.shift.y(), 0);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (int panel = 0; panel < static_cast<int>(length / kPanel); ++panel) {
      const Texture texture = textures.empty()
                                  ? make_texture()
                                  : textures[static_cast<std::size_t>(choice.below(hall.textures))];
      for (const WorldPoint& p : texture)
        points.push_back({corner + R * (p.position + Eigen::Vector3d(kPanel * panel, 0, 0)),
                          R * p.facing, p.descriptor});
    }
  };
  constexpr double kQuarter = std::numbers::pi / 2;
  wall({0, 0, 0}, hall.length, 0);
  wall({hall.length, 0, 0}, hall.width, kQuarter);
  wall({hall.length, hall.width, 0}, hall.length, 2 * kQuarter);
  wall({0, hall.width, 0}, hall.width, 3 * kQuarter);
  return points;
}

/// A camera at `position` that looks along `heading` (about z) and slightly up and down.
inline Eigen::Isometry3d camera_pose(const Eigen::Vector3d& position, double heading,
                                     double pitch = 0, double roll = 0) {
  Eigen::Matrix3d R_level;  // camera z along x, camera y down
  R_level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * R_level *
               Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
               Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  T.translation() = position;
  return T;
}

/// On an ellipse in the middle of the hall, looking ahead and outwards; `path` in m.
inline Eigen::Isometry3d pose_on_lap(const HallOptions& hall, double path) {
  const double a = hall.length / 2 - 3, b = hall.width / 2 - 2.5;
  const double lap = std::numbers::pi * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
  const double s = 2 * std::numbers::pi * path / lap;
  // What no two laps have in common.
  const double sway = 0.1 * std::sin(0.37 * path), nod = 0.05 * std::sin(0.8 * path);
  const Eigen::Vector3d position(hall.length / 2 + (a + sway) * std::cos(s),
                                 hall.width / 2 + (b + sway) * std::sin(s), 1.6 + 2 * nod);
  const double tangent = std::atan2(b * std::cos(s), -a * std::sin(s));
  return camera_pose(position, tangent - 0.6, nod, 0.5 * nod);
}

inline double lap_length(const HallOptions& hall) {
  const double a = hall.length / 2 - 3, b = hall.width / 2 - 2.5;
  return std::numbers::pi * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
}

/// An odometry that drifts by a constant vector and a constant turn of the heading per metre;
/// gravity it knows.
class DriftingOdometry {
 public:
  DriftingOdometry(const Eigen::Vector3d& drift_per_m, double yaw_per_m)
      : drift_per_m_(drift_per_m), yaw_per_m_(yaw_per_m) {}

  Eigen::Isometry3d follow(const Eigen::Isometry3d& T_true) {
    if (started_) {
      const Eigen::Vector3d moved = T_true.translation() - last_.translation();
      position_ += about_z(yaw_) * moved + moved.norm() * drift_per_m_;
      yaw_ += yaw_per_m_ * moved.norm();
    } else {
      position_ = T_true.translation();
    }
    started_ = true;
    last_ = T_true;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = about_z(yaw_) * T_true.linear();
    T.translation() = position_;
    return T;
  }

 private:
  static Eigen::Matrix3d about_z(double angle) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }

  Eigen::Vector3d drift_per_m_;
  double yaw_per_m_;
  bool started_ = false;
  Eigen::Isometry3d last_;
  Eigen::Vector3d position_;
  double yaw_ = 0;
};

inline constexpr LoopCamera kLoopCamera{kCamera, 160, 120, 1};

template <class P>
P to_pose(const Eigen::Isometry3d& T) {
  P pose;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) pose.R.m[r][c] = static_cast<float>(T.linear()(r, c));
  pose.t = {static_cast<float>(T.translation().x()), static_cast<float>(T.translation().y()),
            static_cast<float>(T.translation().z())};
  return pose;
}

inline Eigen::Vector3d position_of(const Pose<work::Native>& T) {
  return {double(T.t.x), double(T.t.y), double(T.t.z)};
}

/// What a camera sees.
struct Sight {
  struct Feature {
    int u, v;
    Descriptor descriptor;
    bool tracked;
    Eigen::Vector3d in_camera;
  };
  std::vector<Feature> features;
};

inline Sight look(const std::vector<WorldPoint>& world, const Eigen::Isometry3d& T_world_camera,
                  Random& random) {
  constexpr double kMissed = 0.25, kFlipped = 0.07, kPixel = 0.4, kDepth = 0.02;
  constexpr int kMost = 250, kClutter = 60;
  Sight sight;
  const auto add = [&](double u, double v, const Descriptor& words, bool tracked,
                       const Eigen::Vector3d& x) {
    const int column = static_cast<int>(std::lround(u)), row = static_cast<int>(std::lround(v));
    if (column < 16 || column >= 144 || row < 16 || row >= 104) return;
    sight.features.push_back({column, row, words, tracked, x});
  };
  for (const WorldPoint& p : world) {
    if (static_cast<int>(sight.features.size()) >= kMost) break;
    const Eigen::Vector3d ray = p.position - T_world_camera.translation();
    if (ray.squaredNorm() > 144 || ray.dot(p.facing) > 0) continue;
    const Eigen::Vector3d x = T_world_camera.linear().transpose() * ray;
    if (x.z() < 0.3 || random.uniform(0, 1) < kMissed) continue;
    // One random number after the other, whatever the compiler.
    const double u =
        double(kCamera.fx) * x.x() / x.z() + double(kCamera.cx) + kPixel * normal_variate(random);
    const double v =
        double(kCamera.fy) * x.y() / x.z() + double(kCamera.cy) + kPixel * normal_variate(random);
    const Descriptor words = with_flipped_bits(p.descriptor, random, kFlipped);
    const bool tracked = random.uniform(0, 1) < 0.7;
    add(u, v, words, tracked, x * (1 + kDepth * normal_variate(random)));
  }
  for (int i = 0; i < kClutter; ++i) {
    const double u = random.uniform(16, 144);
    const double v = random.uniform(16, 104);
    add(u, v, random_descriptor(random), false, Eigen::Vector3d::Zero());
  }
  return sight;
}

/// A sight in local memory, and the closer that it is shown to.
template <class P>
class LoopFlight {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;

  explicit LoopFlight(const LoopOptions& options, bool record = false)
      : machine_({8, "L1", Bytes(1 << 17), 1, record}),
        memory_("L2", Bytes(1 << 20)),
        closer_(options, kLoopCamera, machine_, memory_) {}

  LoopOutcome show(const Sight& sight, const Eigen::Isometry3d& T_odometry_camera) {
    work::Arena& local = machine_.local();
    const work::Arena::Frame frame(local);
    {
      const auto stage = machine_.stage(stages::kPlaceRecognition);
      if (!closer_.is_due(to_pose<Pose<P>>(T_odometry_camera))) return {};
    }
    const int n = static_cast<int>(sight.features.size());
    LoopView<P> view;
    view.features = alloc_features<P>(local, n);
    view.features.count = n;
    view.tracked = local.alloc<typename P::template Span<typename P::U16>>("tracked", n);
    view.points = local.alloc<typename P::template Span<F>>("points", 3 * n);
    view.T_odometry_camera = to_pose<Pose<P>>(T_odometry_camera);
    for (int i = 0; i < n; ++i) {
      const Sight::Feature& f = sight.features[static_cast<std::size_t>(i)];
      view.features.x[i] = static_cast<std::uint16_t>(f.u);
      view.features.y[i] = static_cast<std::uint16_t>(f.v);
      for (int w = 0; w < 8; ++w)
        view.features.descriptors[8 * i + w] = f.descriptor[static_cast<std::size_t>(w)];
      if (!f.tracked) continue;
      view.tracked[view.tracked_count] = static_cast<std::uint16_t>(i);
      for (int c = 0; c < 3; ++c)
        view.points[3 * view.tracked_count + c] = F(static_cast<float>(f.in_camera[c]));
      ++view.tracked_count;
    }
    const LoopOutcome outcome = closer_.visit(view);
    while (closer_.has_to_improve()) closer_.improve();
    closures += outcome.closures;
    removed += outcome.removed;
    return outcome;
  }

  /// After dt; in the corrected world.
  Pose<P> corrected(const Eigen::Isometry3d& T_odometry_camera, float dt) {
    return closer_.corrected(to_pose<Pose<P>>(T_odometry_camera), dt);
  }

  work::Machine& machine() { return machine_; }
  const work::Arena& memory() const { return memory_; }

  int closures = 0, removed = 0;

 private:
  work::Machine machine_;
  work::Arena memory_;
  LoopCloser<P> closer_;
};

}  // namespace leviosim::vio::test
