#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <optional>
#include <string>

#include "tests/workload/graph/optimiser_scene.h"
#include "workload/graph/visual_terms.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;
using GraphScene = OptimiserScene<Native>;

TEST(Optimiser, FindsTheTruthFromExactMeasurements) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OptimiserSceneOptions options;
    options.seed = seed;
    GraphScene scene(options);
    ASSERT_GT(scene.position_rms(), 0.05);
    const auto reports = scene.optimise(10);
    EXPECT_LT(scene.position_rms(), 2e-3) << "seed " << seed;
    EXPECT_LT(scene.rotation_rms(), 2e-4) << "seed " << seed;
    EXPECT_LT(scene.velocity_rms(), 1e-2) << "seed " << seed;
    EXPECT_LT(scene.point_median(), 1e-2) << "seed " << seed;
    EXPECT_LT(reports.back().cost_after, 0.1f) << "seed " << seed;
  }
}

TEST(Optimiser, CostNeverRisesAndEveryStepCanBeSolved) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OptimiserSceneOptions options;
    options.seed = seed;
    options.whole_pixels = true;
    GraphScene scene(options);
    float cost = 0;
    for (const IterationReport& r : scene.optimise(12)) {
      EXPECT_TRUE(r.positive_definite);
      EXPECT_EQ(r.accepted, r.cost_after < r.cost_before);
      if (cost > 0) {
        EXPECT_LE(r.cost_before, cost * 1.00001f);
      }
      cost = r.accepted ? r.cost_after : r.cost_before;
    }
    EXPECT_LT(cost, 200.0f);
  }
}

TEST(Optimiser, ARejectedStepChangesNothingButTheDamping) {
  OptimiserSceneOptions options;
  options.whole_pixels = true;
  GraphScene scene(options);
  scene.optimise(15);  // as far as single precision goes
  LmState<Native> lm(scene.options);
  bool seen = false;
  for (int i = 0; i < 10 && !seen; ++i) {
    const WindowState<Native>& state = scene.window.state;
    const std::vector<float> poses(state.poses.data(), state.poses.data() + 96);
    const std::vector<float> points(state.points.data(),
                                    state.points.data() + 3 * scene.window.landmarks);
    const float lambda = lm.lambda;
    const auto stage = scene.fc.stage("optimiser");
    if (optimise_once<Native>(scene.fc, scene.window, lm, scene.options).accepted) continue;
    seen = true;
    EXPECT_EQ(0, std::memcmp(poses.data(), state.poses.data(), 4 * poses.size()));
    EXPECT_EQ(0, std::memcmp(points.data(), state.points.data(), 4 * points.size()));
    EXPECT_FLOAT_EQ(lm.lambda, lambda * scene.options.lambda_up);
  }
  EXPECT_TRUE(seen);
}

TEST(Optimiser, ALandmarkThatLeavesTheViewStaysWhereItWas) {
  GraphScene scene;
  const PixelModel<Native> model(scene.options.visual);
  const Window<Native>& window = scene.window;
  std::vector<float> points(window.state.points.data(),
                            window.state.points.data() + 3 * window.landmarks);
  WindowState<Native> trial = window.state;
  trial.points = {points.data(), static_cast<int>(points.size())};
  const float cost = settle_points<Native>(window, trial, model);
  const Vector3d ahead = Motion::rotation(0).col(2);
  for (int c = 0; c < 3; ++c) points[3 * 7 + c] -= static_cast<float>(20 * ahead[c]);
  points[3 * 8] += 1e-3f;  // a harmless step
  EXPECT_NEAR(settle_points<Native>(window, trial, model), cost, 0.01f * cost + 1);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(points[3 * 7 + c], window.state.points[3 * 7 + c]);
  EXPECT_NE(points[3 * 8], window.state.points[3 * 8]);
}

TEST(Optimiser, MarksLandmarksItHasLost) {
  GraphScene scene;
  const Vector3d ahead = Motion::rotation(0).col(2);
  for (int c = 0; c < 3; ++c)
    scene.window.state.points[3 * 7 + c] -= static_cast<float>(20 * ahead[c]);
  scene.optimise(3);
  int lost = 0;
  for (int i = 0; i < scene.window.landmarks; ++i) lost += scene.window.lost[i];
  EXPECT_EQ(scene.window.lost[7], 1);
  EXPECT_EQ(lost, 1);
}

/// What the first joint iterations say of the scale of a window whose first velocity is known that
/// well, m/s.
std::vector<std::optional<float>> scale_sigmas(float velocity, double interval_s = 0.2) {
  GraphScene scene({.interval_s = interval_s});
  scene.options.prior.velocity = velocity;
  WindowPrior<Native> prior(scene.fc.local(), scene.graph.capacity.keyframes);
  start_prior<Native>(scene.window, scene.options.prior, prior);
  LmState<Native> lm(scene.options);
  std::vector<std::optional<float>> sigmas;
  for (int i = 0; i < 4; ++i) {
    const auto stage = scene.fc.stage("optimiser");
    sigmas.push_back(optimise_jointly_once<Native>(scene.fc, scene.window, prior, lm, scene.options)
                         .scale_sigma);
  }
  return sigmas;
}

/// 1.4 s along a path of 0.4 m RMS about its centre. The accelerometer's noise moves its end by
/// 0.1 m/s²/√Hz √((1.4 s)³ / 3) = 0.1 m if the velocity at its beginning is known, else by more.
TEST(Optimiser, TheScaleIsAsUncertainAsTheImuLeavesIt) {
  const std::vector<std::optional<float>> known = scale_sigmas(0.01f);
  EXPECT_FALSE(known.front());  // damping would hide what is uncertain
  ASSERT_TRUE(known.back());
  EXPECT_GT(*known.back(), 0.05f);
  EXPECT_LT(*known.back(), 0.15f);
  const float unknown = scale_sigmas(1).back().value();
  EXPECT_GT(unknown, 2 * *known.back());
  EXPECT_NEAR(scale_sigmas(10).back().value(), unknown, 0.1f * unknown);
  // A quarter of the time, and of the path: it bends by a sixteenth, and noise by an eighth.
  EXPECT_GT(scale_sigmas(1, 0.05).back().value(), unknown);
}

/// What a joint iteration with that damping says of the scale, at the minimum.
float sigma_of_damped(float lambda, double interval_s) {
  GraphScene scene({.interval_s = interval_s});
  WindowPrior<Native> prior(scene.fc.local(), scene.graph.capacity.keyframes);
  start_prior<Native>(scene.window, scene.options.prior, prior);
  LmState<Native> lm(scene.options);
  std::optional<float> sigma;
  for (int i = 0; i < 4; ++i) {
    lm.lambda = i < 3 ? 1e-6f : lambda;
    const auto stage = scene.fc.stage("optimiser");
    sigma =
        optimise_jointly_once<Native>(scene.fc, scene.window, prior, lm, scene.options).scale_sigma;
  }
  return sigma.value();
}

/// The damping of landmarks does, by a fifth at 1e-6.
TEST(Optimiser, DampingOfKeyframesDoesNotMakeTheScaleMoreCertain) {
  const float nearly_free = sigma_of_damped(1e-7f, 0.2);
  EXPECT_GT(sigma_of_damped(1e-6f, 0.2), 0.8f * nearly_free);
  EXPECT_LT(sigma_of_damped(1e-6f, 0.2), nearly_free);
  EXPECT_GT(sigma_of_damped(2e-6f, 0.05), 0.28f);  // 0.24 with it
}

TEST(Optimiser, TheFirstVelocityOfAllHasAnAnchorOfItsOwn) {
  GraphScene scene;
  AnchorOptions anchor;
  anchor.velocity = 0.1f;
  anchor.initial_velocity = 2.0f;
  const auto held = [&] {
    const ReducedSystem<Native> system(scene.fc.local(), scene.window.keyframes, true);
    system.clear();
    add_anchor<Native>(scene.window, anchor, system);
    return system.matrix()(6, 6);
  };
  EXPECT_FLOAT_EQ(held(), 0.25f);
  scene.window.keyframe_ids[0] = 1;
  EXPECT_FLOAT_EQ(held(), 100.0f);
}

TEST(Optimiser, DampingFallsWithSuccess) {
  GraphScene scene;
  const auto reports = scene.optimise(4);
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_FLOAT_EQ(reports[i].lambda,
                    std::max(reports[i - 1].lambda * 0.1f, scene.options.min_lambda));
}

TEST(Optimiser, HuberLimitsTheInfluenceOfOutliers) {
  OptimiserSceneOptions options;
  options.outliers = 0.05;
  GraphScene robust(options), plain(options);
  plain.options.visual.huber_px = 1e6f;
  robust.optimise(30);
  plain.optimise(30);
  EXPECT_LT(robust.position_rms(), 0.02);
  EXPECT_LT(robust.rotation_rms(), 0.005);
  EXPECT_GT(plain.position_rms(), 3 * robust.position_rms());
  EXPECT_GT(plain.rotation_rms(), 3 * robust.rotation_rms());
}

TEST(Optimiser, WithoutImuFindsThePosesUpToScale) {
  GraphScene scene;
  scene.options.use_imu = false;
  const std::vector<float> velocities(scene.window.state.velocities.data(),
                                      scene.window.state.velocities.data() + 24);
  scene.optimise(15);
  const Vector3d origin = Motion::position(0);
  double dot = 0, square = 0;
  for (int k = 0; k < 8; ++k) {
    const Vector3d found = to_eigen<Native>(scene.window.state.pose(k).t) - origin;
    dot += found.dot(Motion::position(scene.time(k)) - origin);
    square += found.squaredNorm();
  }
  const double scale = dot / square;
  for (int k = 0; k < 8; ++k) {
    const Vector3d found = to_eigen<Native>(scene.window.state.pose(k).t) - origin;
    EXPECT_LT((scale * found + origin - Motion::position(scene.time(k))).norm(), 2e-3);
  }
  EXPECT_LT(scene.rotation_rms(), 2e-4);
  EXPECT_EQ(0, std::memcmp(velocities.data(), scene.window.state.velocities.data(), 96));
}

/// Everything scaled about the anchored camera: images alone cannot tell, the IMU can.
TEST(Optimiser, ImuRestoresTheScale) {
  OptimiserSceneOptions options;
  options.rotation_noise = options.position_noise = options.velocity_noise = options.depth_noise =
      0;
  const auto scale_after = [&](bool use_imu) {
    GraphScene scene(options);
    scene.options.use_imu = use_imu;
    const Vector3d origin = Motion::position(0);
    const auto scaled_about = [&](const Vec3<Native>& x) {
      return to_vec3<Native>(origin + 1.2 * (to_eigen<Native>(x) - origin));
    };
    for (int k = 0; k < 8; ++k) {
      KeyframeState<Native> s = scene.window.state.keyframe(k);
      s.T_world_camera.t = scaled_about(s.T_world_camera.t);
      s.velocity = s.velocity * 1.2f;
      scene.window.state.set_keyframe(k, s);
    }
    const auto points = scene.window.state.points;
    for (int i = 0; i < scene.window.landmarks; ++i)
      store_vec3<Native>(points, 3 * i, scaled_about(load_vec3<Native>(points, 3 * i)));
    scene.optimise(12);
    return (to_eigen<Native>(scene.window.state.pose(7).t) - origin).norm() /
           (Motion::position(scene.time(7)) - origin).norm();
  };
  EXPECT_NEAR(scale_after(true), 1.0, 0.01);
  EXPECT_NEAR(scale_after(false), 1.2, 0.01);
}

TEST(Optimiser, AnchorHoldsTheOldestKeyframe) {
  GraphScene scene;
  scene.optimise(8);
  EXPECT_LT(scene.position_error(0), 1e-4);
  EXPECT_LT(scene.rotation_error(0), 1e-4);
}

TEST(Optimiser, LeavesASingleKeyframeAlone) {
  OptimiserSceneOptions options;
  options.keyframes = 1;
  options.landmarks = 5;
  options.shortest_track = options.longest_track = 1;
  GraphScene scene(options);
  const auto reports = scene.optimise(1);
  EXPECT_FALSE(reports[0].accepted);
  EXPECT_EQ(scene.position_error(0), GraphScene(options).position_error(0));
}

/// A window of inertial intervals only: the motion follows the IMU.
TEST(Optimiser, WorksWithoutLandmarks) {
  OptimiserSceneOptions options;
  options.landmarks = 0;
  options.position_noise = 0.01;
  GraphScene scene(options);
  scene.optimise(5);
  EXPECT_LT(scene.rotation_rms(), 1e-3);
}

TEST(Optimiser, AShortWindowUsesWhatItHas) {
  OptimiserSceneOptions options;
  options.keyframes = 3;
  options.shortest_track = 2;
  options.longest_track = 3;
  options.landmarks = 60;
  GraphScene scene(options);
  const auto reports = scene.optimise(10);
  EXPECT_TRUE(reports.back().positive_definite);
  EXPECT_LT(reports.back().cost_after, 0.1f);
  EXPECT_LT(scene.rotation_rms(), 1e-3);
}

OptimiserSceneOptions full_window() {
  OptimiserSceneOptions options;
  options.landmarks = 1000;
  options.shortest_track = 2;
  options.longest_track = 2;
  return options;
}

TEST(Optimiser, WorkMemoryIsThePapersAtAFullWindow) {
  OptimiserScene<Native> scene(full_window(), true);
  ASSERT_EQ(scene.window.landmarks, 1000);
  scene.optimise(1);
  std::map<std::string, std::int64_t> bytes;
  std::int64_t total = 0;
  const work::Job job = scene.fc.take_job();
  for (const work::Block& block : job.stages.back().memory.blocks) {
    bytes[std::string(block.name)] += block.size.count();
    total += block.size.count();
  }
  for (const GraphBlock& block : kGraphBlocks) total -= bytes.at(std::string(block.name));
  EXPECT_EQ(bytes.at("landmark Jacobian records"), 676'000);
  EXPECT_NEAR(static_cast<double>(total), 743'600, 0.01 * 743'600);
}

TEST(Optimiser, CountsWhatItComputesNatively) {
  for (const bool use_imu : {true, false}) {
    OptimiserSceneOptions options;
    options.outliers = 0.05;
    OptimiserScene<Native> native(options);
    OptimiserScene<Counting> counting(options);
    native.options.use_imu = counting.options.use_imu = use_imu;
    const auto a = native.optimise(8);
    const auto b = counting.optimise(8);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(a[i].cost_after, b[i].cost_after);
    const WindowState<Native>& x = native.window.state;
    const WindowState<Counting>& y = counting.window.state;
    EXPECT_EQ(0, std::memcmp(x.poses.data(), y.poses.data(), 4 * 96));
    EXPECT_EQ(0, std::memcmp(x.velocities.data(), y.velocities.data(), 4 * 24));
    EXPECT_EQ(0, std::memcmp(x.points.data(), y.points.data(),
                             12 * static_cast<std::size_t>(native.window.landmarks)));
  }
}

}  // namespace
}  // namespace leviosim::vio::test
