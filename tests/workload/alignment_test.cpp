// The initialisation in motion: velocity, gravity, biases and scale from a window of keyframes.
#include <gtest/gtest.h>

#include <vector>

#include "preintegration_motion.h"
#include "workload/graph/alignment.h"
#include "workload/inertial/initialisation.h"

namespace leviosim::vio::test {
namespace {

using work::Native;

/// Motion's path in a world whose z axis points up.
const Matrix3d kUp = exp_of({-M_PI / 2, 0, 0});

struct Options {
  int keyframes = 10;
  double interval_s = 0.12;
  double begin_s = 0.2;
  double pace = 1;  ///< of the path in time; 0: hovering, while the IMU is as in flight
  double outliers = 0;
  bool whole_pixels = false;
};

/// A graph as the front end leaves it before the alignment: velocity and biases unknown, attitude
/// from the first force, every landmark at the same distance.
struct Scene {
  explicit Scene(const Options& o = {})
      : options(o),
        fc({.cores = 1, .memory = "L2", .capacity = Bytes(1'600'000)}),
        graph(fc.local(), {12, 1000, 2400}),
        window(fc.local(), {12, 1000, 2400}) {
    const float unit = options.whole_pixels ? 1 : 64;
    PinholeCamera& camera = optimiser.visual.camera;
    for (float* parameter :
         {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &optimiser.visual.sigma_px,
          &optimiser.visual.huber_px, &optimiser.visual.lost_px})
      *parameter *= unit;
    const Vector3d force = motion.specific_force(options.begin_s);
    graph.clear(ImuBias<Native>::zero(), {0, 0, -kGravity});
    const Mat3<Native> R = upright_rotation<Native>(vec3<Native>(force));
    for (int k = 0; k < options.keyframes; ++k) {
      const OwnedInterval<Native> interval;
      interval.reset(ImuBias<Native>::zero());
      if (k > 0)
        integrate<Native>(motion, time(k - 1), time(k), 24, interval, ImuBias<Native>::zero(),
                          gyro_bias, accel_bias);
      graph.add_keyframe({{R, {0, 0, 0}}, {0, 0, 0}}, interval.record());
      graph.age_landmarks();
    }
    add_landmarks(R);
    take_snapshot<Native>(graph, ImuNoise{}, fc.local(), window);
  }

  double time(int k) const { return options.begin_s + options.interval_s * k; }
  static Vector3d position(double t) { return kUp * Motion::position(t); }
  static Matrix3d rotation(double t) { return kUp * Motion::rotation(t); }

  void add_landmarks(const Mat3<Native>& R) {
    const PinholeCamera& c = optimiser.visual.camera;
    const std::vector<Native::U32> no_descriptor(8);
    TestRandom random(3);
    for (int i = 0; i < 150; ++i) {
      const int first = static_cast<int>(random.uniform(0, options.keyframes - 3));
      const int last = std::min(options.keyframes - 1, first + 2 + i % 6);
      const double depth = random.uniform(1.5, 8);
      const Vector3d ray(random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4), 1);
      const Vector3d point = rotation(time(first)) * (ray * depth) + position(time(first));
      int slot = -1;
      for (int k = first; k <= last; ++k) {
        Vector3d x = rotation(time(k)).transpose() * (point - position(time(k)));
        Eigen::Vector2d pixel(c.fx * x.x() / x.z() + c.cx, c.fy * x.y() / x.z() + c.cy);
        if (random.uniform(0, 1) < options.outliers) pixel += Eigen::Vector2d(12, -9) * c.fx / 114;
        if (slot < 0) {
          const float d = 1 / AlignmentOptions().inverse_depth;
          slot = graph.add_landmark(
              R * Vec3<Native>{static_cast<float>(ray.x()) * d, static_cast<float>(ray.y()) * d, d},
              no_descriptor);
        }
        graph.add_observation(k, slot, static_cast<int>(std::lround(pixel.x())),
                              static_cast<int>(std::lround(pixel.y())));
      }
    }
  }

  AlignmentReport align(int most) {
    AlignmentReport report;
    LmState<Native> lm(optimiser);
    for (int i = 0; i < most && !report.determined; ++i) {
      const auto stage = fc.stage("initialisation");
      report = align_once<Native>(fc, window, lm, optimiser, alignment);
      iterations = i + 1;
      if (std::getenv("ALIGN_TRACE"))
        std::printf(
            "%d cost %.1f -> %.1f lambda %g acc %d unc %.3f lm %d v %.3f %.3f %.3f bg %.3f\n", i,
            report.cost_before, report.cost_after, report.lambda, report.accepted,
            report.uncertainty, report.landmarks, window.state.keyframe(0).velocity.x,
            window.state.keyframe(0).velocity.y, window.state.keyframe(0).velocity.z,
            window.bias.gyro.x);
    }
    return report;
  }

  /// Length of the way over the window, over the true one.
  double scale() const {
    const int last = options.keyframes - 1;
    return eigen<Native>(window.state.pose(last).t - window.state.pose(0).t).norm() /
           (position(time(last)) - position(time(0))).norm();
  }
  double tilt_error() const {
    const Vector3d down = eigen<Native>(window.state.pose(0).R).transpose() * Vector3d(0, 0, -1);
    return std::acos(down.dot(rotation(time(0)).transpose() * Vector3d(0, 0, -1)));
  }
  double velocity_error() const {
    const Vector3d v = eigen<Native>(window.state.pose(0).R).transpose() *
                       eigen<Native>(window.state.keyframe(0).velocity);
    return (v - Motion::rotation(time(0)).transpose() * Motion::velocity(time(0))).norm();
  }

  Options options;
  Motion motion;
  Vector3d gyro_bias{0.05, -0.03, 0.06}, accel_bias{0.05, 0.08, -0.04};
  OptimiserOptions optimiser;
  AlignmentOptions alignment;
  work::Machine fc;
  PoseGraph<Native> graph;
  Window<Native> window;
  int iterations = 0;
};

TEST(Alignment, FindsVelocityGravityAndBiasesOfAFlight) {
  Scene scene;
  const AlignmentReport report = scene.align(30);
  EXPECT_TRUE(report.determined);
  EXPECT_NEAR(scene.scale(), 1, 0.03);
  EXPECT_LT(scene.tilt_error(), 0.015);
  EXPECT_LT(scene.velocity_error(), 0.05);
  EXPECT_LT((eigen<Native>(scene.window.bias.gyro) - scene.gyro_bias).norm(), 0.005);
}

TEST(Alignment, IsRobustAgainstWrongMatches) {
  Scene scene({.outliers = 0.1});
  EXPECT_TRUE(scene.align(30).determined);
  EXPECT_NEAR(scene.scale(), 1, 0.06);
}

}  // namespace
}  // namespace leviosim::vio::test
