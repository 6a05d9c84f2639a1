// The initialisation in motion: velocity, gravity, biases and scale from a window of keyframes.
#include <gtest/gtest.h>

#include <vector>

#include "sim/work/machine.h"
#include "tests/workload/inertial/preintegration_motion.h"
#include "tests/workload/math/eigen_conversions.h"
#include "workload/graph/alignment.h"
#include "workload/inertial/initialisation.h"

namespace leviosim::vio::test {
namespace {

using work::Native;

/// Motion's path in a world whose z axis points up.
const Matrix3d kUp = exp_of({-M_PI / 2, 0, 0});

struct Options {
  int keyframes = 12;
  double interval_s = 0.15;
  double outliers = 0;      ///< share of observations that are 15 px off
  double distance = 1;      ///< of the points, times 2 to 8 m
  bool accelerates = true;  ///< otherwise the camera flies on at the speed that it has at first
};

/// A graph as the front end leaves it before the alignment, keyframe by keyframe: velocity and
/// biases unknown, attitude from the first force, every landmark at the same distance.
struct MovingScene {
  explicit MovingScene(const Options& o = {})
      : options(o),
        fc({.cores = 1, .memory = "L2", .capacity = Bytes(1'600'000)}),
        graph(fc.local(), {12, 1000, 2400}),
        window(fc.local(), {12, 1000, 2400}) {
    constexpr float kUnit = 64;  // per pixel, so that rounding says nothing
    PinholeCamera& camera = optimiser.visual.camera;
    for (float* parameter :
         {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &optimiser.visual.sigma_px,
          &optimiser.visual.huber_px, &optimiser.visual.lost_px})
      *parameter *= kUnit;
    optimiser.visual.sigma_px *= 0.3f;
    graph.clear(ImuBias<Native>::zero(), {0, 0, -kGravity});
    graph.set_bias_prior(BiasPrior<Native>::unknown({}));
    T_world_first = {upright_rotation<Native>(to_vec3<Native>(force(time(0)))), {0, 0, 0}};
    TestRandom scatter(3);
    for (int i = 0; i < 150; ++i) {
      const int first = static_cast<int>(scatter.uniform(0, options.keyframes - 3));
      const Vector3d ray(scatter.uniform(-0.5, 0.5), scatter.uniform(-0.4, 0.4), 1);
      const Vector3d in_camera = ray * (scatter.uniform(2, 8) * options.distance);
      points.push_back({rotation(time(first)) * in_camera + position(time(first)), first,
                        first + 2 + i % 6, -1});
    }
  }

  // The motion, in a world whose z axis points up.
  double time(int k) const { return 0.2 + options.interval_s * k; }
  double flown(double t) const { return options.accelerates ? t : time(0); }
  Vector3d position(double t) const {
    return kUp * (Motion::position(flown(t)) + Motion::velocity(time(0)) * (t - flown(t)));
  }
  Matrix3d rotation(double t) const { return kUp * Motion::rotation(flown(t)); }
  Vector3d force(double t) const {
    if (options.accelerates) return motion.specific_force(t);
    return Motion::rotation(time(0)).transpose() * -motion.gravity;
  }
  ImuSample<Native> sample(double t, double dt) const {
    const Vector3d rate = options.accelerates ? Motion::rate(t) : Vector3d::Zero();
    return {static_cast<float>(dt), to_vec3<Native>(rate + gyro_bias),
            to_vec3<Native>(force(t) + accel_bias)};
  }

  void add_keyframe(int k) {
    const OwnedInterval<Native> interval;
    interval.reset(ImuBias<Native>::zero());
    constexpr int kSteps = 30;
    const double dt = options.interval_s / kSteps;
    for (int i = 0; k > 0 && i < kSteps; ++i)
      interval.integrate(sample(time(k - 1) + i * dt, dt), sample(time(k - 1) + (i + 1) * dt, dt),
                         ImuNoise{});
    const KeyframeState<Native> last = k == 0 ? KeyframeState<Native>{T_world_first, {0, 0, 0}}
                                              : graph.keyframe(graph.newest_keyframe());
    graph.age_landmarks();
    graph.add_keyframe(last, interval.record());
    for (Point& point : points)
      if (k >= point.first && k <= point.last) observe(k, point, last.T_world_camera);
  }

  /// All keyframes at once, in the window.
  void take_all() {
    for (int k = 0; k < options.keyframes; ++k) add_keyframe(k);
    take_snapshot<Native>(graph, ImuNoise{}, fc.local(), window);
  }
  /// @param afresh  the first of the iterations forgets what was found before
  void iterate(int iterations, bool afresh) {
    AlignmentState<Native> state{alignment.initial_lambda, inverse_depth};
    for (int i = 0; i < iterations; ++i) {
      const auto stage = fc.stage("initialisation");
      report = align_once<Native>(fc, window, state, optimiser, alignment, afresh && i == 0);
    }
  }

  /// Aligns whenever there is a keyframe more, as the back end does.
  /// @return the number of keyframes with which it was determined, or 0
  int align() {
    for (int k = 0; k < options.keyframes; ++k) {
      add_keyframe(k);
      if (k + 1 < alignment.min_keyframes) continue;
      take_snapshot<Native>(graph, ImuNoise{}, fc.local(), window);
      AlignmentState<Native> state{alignment.initial_lambda, inverse_depth};
      report = align_from_all<Native>(fc, window, state, optimiser, alignment);
      inverse_depth = state.inverse_depth;
      if (report.determined) return k + 1;
      for (int i = 0; i < window.landmarks; ++i) window.lost[i] = 0;
      publish<Native>(window, graph);
    }
    return 0;
  }

  /// Length of the way over the window, over the true one.
  double scale() const {
    const int last = window.keyframes - 1;
    return to_eigen<Native>(window.state.pose(last).t - window.state.pose(0).t).norm() /
           (position(time(last)) - position(time(0))).norm();
  }
  double tilt_error() const {
    const Vector3d down = to_eigen<Native>(window.state.pose(0).R).transpose() * Vector3d(0, 0, -1);
    return std::acos(down.dot(rotation(time(0)).transpose() * Vector3d(0, 0, -1)));
  }
  double velocity_error() const {
    const Vector3d v = to_eigen<Native>(window.state.pose(0).R).transpose() *
                       to_eigen<Native>(window.state.keyframe(0).velocity);
    return (v - Motion::rotation(time(0)).transpose() * Motion::velocity(time(0))).norm();
  }

  struct Point {
    Vector3d at;
    int first, last;  ///< keyframes that see it
    int slot;
  };

  void observe(int k, Point& point, const Pose<Native>& T_world_camera) {
    const PinholeCamera& c = optimiser.visual.camera;
    const Vector3d x = rotation(time(k)).transpose() * (point.at - position(time(k)));
    if (x.z() < 0.1) return;
    double u = static_cast<double>(c.fx) * x.x() / x.z() + static_cast<double>(c.cx);
    double v = static_cast<double>(c.fy) * x.y() / x.z() + static_cast<double>(c.cy);
    if (random.uniform(0, 1) < options.outliers) u += 15 * 64;
    if (u < 0 || v < 0 || u > 160 * 64 || v > 120 * 64) return;
    if (point.slot < 0) {
      const float depth = 1 / inverse_depth;
      const Vec3<Native> seen{static_cast<float>(x.x() / x.z()) * depth,
                              static_cast<float>(x.y() / x.z()) * depth, depth};
      const std::vector<Native::U32> no_descriptor(8);
      point.slot = graph.add_landmark(T_world_camera * seen, no_descriptor);
    }
    graph.add_observation(graph.newest_keyframe(), point.slot, static_cast<int>(std::lround(u)),
                          static_cast<int>(std::lround(v)));
  }

  Options options;
  Motion motion;
  Pose<Native> T_world_first;
  std::vector<Point> points;
  TestRandom random{9};
  AlignmentReport report;
  Vector3d gyro_bias{0.05, -0.03, 0.06}, accel_bias{0.05, 0.08, -0.04};
  OptimiserOptions optimiser;
  AlignmentOptions alignment;
  float inverse_depth = alignment.inverse_depth;  ///< mean, as the last alignment has it
  work::Machine fc;
  PoseGraph<Native> graph;
  Window<Native> window;
};

TEST(Alignment, FindsVelocityGravityAndBiasesOfAFlight) {
  MovingScene scene;
  EXPECT_GT(scene.align(), scene.alignment.few_keyframes);
  EXPECT_NEAR(scene.scale(), 1, 0.05);
  EXPECT_LT(scene.tilt_error(), 0.02);
  EXPECT_LT(scene.velocity_error(), 0.1);
  EXPECT_LT((to_eigen<Native>(scene.window.bias.gyro) - scene.gyro_bias).norm(), 0.01);
}

/// No distance is assumed: what is seen may be half a metre or twenty metres away.
TEST(Alignment, FindsTheScaleOfNearAndFarScenes) {
  for (const double distance : {0.25, 0.5, 2.5}) {
    MovingScene scene({.distance = distance});
    EXPECT_GT(scene.align(), 0) << distance;
    EXPECT_NEAR(scene.scale(), 1, 0.1) << distance;
  }
}

TEST(Alignment, IsRobustAgainstWrongMatches) {
  MovingScene scene({.outliers = 0.05});
  scene.alignment.min_explained = 0.5f;
  EXPECT_GT(scene.align(), 0);
  EXPECT_NEAR(scene.scale(), 1, 0.1);
}

/// Without acceleration no IMU tells how fast the camera is.
TEST(Alignment, WaitsWhileTheMotionTellsNoScale) {
  MovingScene scene({.keyframes = 11, .accelerates = false});
  EXPECT_EQ(scene.align(), 0);
  EXPECT_GT(scene.report.uncertainty, scene.alignment.max_uncertainty);
}

TEST(Alignment, RefusesBiasesThatCannotBeTrue) {
  MovingScene scene;
  scene.accel_bias = {0.5, -0.4, 0.5};
  EXPECT_EQ(scene.align(), 0);
}

/// Far from its minimum an alignment is not told apart from a good one by its uncertainty: its
/// distance from the minimum decides, whatever else speaks for it.
TEST(Alignment, HasNotConvergedFarFromItsMinimum) {
  MovingScene scene;
  scene.alignment.max_prior_deviation = 1e3f;
  scene.alignment.min_explained = 0;
  scene.take_all();
  scene.iterate(1, false);
  EXPECT_GT(scene.report.distance, scene.alignment.max_distance);
  EXPECT_FALSE(scene.report.converged);
  EXPECT_FALSE(scene.report.determined);
  scene.iterate(20, false);
  EXPECT_LT(scene.report.distance, 0.1f);
  EXPECT_TRUE(scene.report.converged);
  EXPECT_TRUE(scene.report.determined);
}

/// Velocity, biases and distances found before change nothing but rounding.
TEST(Alignment, ForgetsWhatItFoundBefore) {
  MovingScene scene, other;
  scene.take_all();
  other.take_all();
  Window<Native>& window = other.window;
  window.bias.gyro = {-0.4f, 0.2f, 0.3f};
  KeyframeState<Native> first = window.state.keyframe(0);
  first.velocity = {3, -2, 1};
  window.state.set_keyframe(0, first);
  for (int i = 0; i < window.landmarks; ++i)
    if (window.observation_keyframes[window.first_observations[i]] == 0)
      store_vec3<Native>(window.state.points, 3 * i,
                         load_vec3<Native>(window.state.points, 3 * i) * 3.0f);
  scene.iterate(1, true);
  other.iterate(1, true);
  EXPECT_NEAR(other.report.cost_before, scene.report.cost_before, 1e-3 * scene.report.cost_before);
  EXPECT_NEAR(other.report.distance, scene.report.distance, 1e-3 * scene.report.distance);
  EXPECT_LT(norm(other.window.bias.gyro - scene.window.bias.gyro), 1e-4f);
}

/// The first keyframe is where the map begins: position and heading are not the alignment's to say.
TEST(Alignment, LeavesPositionAndHeadingOfTheFirstKeyframe) {
  MovingScene scene;
  scene.align();
  const Pose<Native> first = scene.window.state.pose(0);
  EXPECT_EQ(norm(first.t), 0.0f);
  const Matrix3d turned =
      to_eigen<Native>(first.R) * to_eigen<Native>(scene.T_world_first.R).transpose();
  EXPECT_LT(std::abs(log_of(turned).z()), 0.01);
}

}  // namespace
}  // namespace leviosim::vio::test
