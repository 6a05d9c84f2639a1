// The normal equations of one iteration, against dense ones in double precision.
#include <gtest/gtest.h>

#include "tests/support/dense_algebra.h"
#include "tests/workload/graph/optimiser_scene.h"
#include "workload/graph/visual_terms.h"

namespace leviosim::vio::test {
namespace {

using work::Native;
using GraphScene = OptimiserScene<Native>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Parts {
  bool visual = true;
  bool imu = true;
  bool anchor = true;
};

/// One linearisation of a scene, undamped but for the landmarks.
struct Linearised {
  Linearised(GraphScene& scene, float lambda, bool velocities, Parts parts = {})
      : frame(scene.fc.local()),
        records(scene.fc.local(), scene.window.landmarks, scene.window.capacity.keyframes),
        system(scene.fc.local(), scene.window.keyframes, velocities),
        elimination(scene.fc.local(), scene.window.capacity.keyframes),
        interval(scene.fc.local()) {
    system.clear();
    float cost = 0;
    if (parts.visual)
      use =
          add_visual_terms<Native>(scene.fc, scene.window, PixelModel<Native>(scene.options.visual),
                                   lambda, records, elimination, system, cost);
    if (parts.imu) add_inertial_terms<Native>(scene.window, interval, system);
    if (parts.anchor) add_anchor<Native>(scene.window, scene.options.anchor, system);
  }
  /// The symmetric matrix of which the lower triangle is kept.
  MatrixXd matrix() const {
    MatrixXd S(system.unknowns(), system.unknowns());
    for (int r = 0; r < S.rows(); ++r)
      for (int c = 0; c < S.cols(); ++c)
        S(r, c) = static_cast<double>(r >= c ? system.matrix()(r, c) : system.matrix()(c, r));
    return S;
  }
  VectorXd vector() const {
    VectorXd b(system.unknowns());
    for (int i = 0; i < b.size(); ++i) b(i) = static_cast<double>(system.vector()[i]);
    return b;
  }

  work::Arena::Frame frame;
  LandmarkRecords<Native> records;
  ReducedSystem<Native> system;
  EliminationScratch<Native> elimination;
  IntervalScratch<Native> interval;
  VisualUse use;
};

/// Normal equations of all unknowns, keyframes first, from the Jacobians in the records.
struct Dense {
  MatrixXd H;
  VectorXd b;
};
Dense dense_visual(const Window<Native>& window, const LandmarkRecords<Native>& records,
                   int per_keyframe, float lambda) {
  const int poses = window.keyframes * per_keyframe;
  const int n = poses + 3 * window.landmarks;
  Dense d{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  for (int i = 0; i < window.landmarks; ++i) {
    for (int j = 0; j < window.observation_numbers[i]; ++j) {
      const int k = window.observation_keyframes[window.first_observations[i] + j];
      const auto slot = records.slot(i, j);
      for (int row = 0; row < 2; ++row) {
        VectorXd J(9);
        for (int c = 0; c < 6; ++c)
          J(c) = static_cast<double>(slot[LandmarkRecords<Native>::kByPose + 6 * row + c]);
        for (int c = 0; c < 3; ++c)
          J(6 + c) = static_cast<double>(slot[LandmarkRecords<Native>::kByPoint + 3 * row + c]);
        const double r = static_cast<double>(slot[LandmarkRecords<Native>::kResidual + row]);
        const auto at = [&](int c) { return c < 6 ? k * per_keyframe + c : poses + 3 * i + c - 6; };
        for (int c = 0; c < 9; ++c) {
          d.b(at(c)) -= J(c) * r;
          for (int e = 0; e < 9; ++e) d.H(at(c), at(e)) += J(c) * J(e);
        }
      }
    }
  }
  for (int i = poses; i < n; ++i) d.H(i, i) *= 1 + static_cast<double>(lambda);
  return d;
}

TEST(NormalEquations, SchurComplementIsThatOfTheDenseMatrix) {
  GraphScene scene;
  const float lambda = 1e-3f;
  const Linearised l(scene, lambda, true, {true, false, false});
  const Dense d = dense_visual(scene.window, l.records, 9, lambda);
  const int p = l.system.unknowns(), n = static_cast<int>(d.b.size()) - p;
  const MatrixXd inverse = tests::inverse(d.H.bottomRightCorner(n, n));
  const MatrixXd W = d.H.topRightCorner(p, n);
  const MatrixXd S = d.H.topLeftCorner(p, p) - W * inverse * W.transpose();
  const VectorXd b = d.b.head(p) - W * inverse * d.b.tail(n);
  EXPECT_LT((l.matrix() - S).norm(), 1e-5 * d.H.topLeftCorner(p, p).norm());
  EXPECT_LT((l.vector() - b).norm(), 1e-5 * d.b.head(p).norm());
}

/// Steps of keyframes and landmarks, against one dense solve of all unknowns.
void expect_steps_of_the_dense_system(bool imu) {
  GraphScene scene;
  const float lambda = 1e-2f;
  Linearised l(scene, lambda, imu, {true, imu, true});
  const Linearised rest(scene, lambda, imu, {false, imu, true});
  Dense d = dense_visual(scene.window, l.records, l.system.per_keyframe(), lambda);
  const int p = l.system.unknowns();
  d.H.topLeftCorner(p, p) += rest.matrix();
  d.b.head(p) += rest.vector();
  for (int i = 0; i < p; ++i) d.H(i, i) += static_cast<double>(lambda * l.system.matrix()(i, i));
  const VectorXd expected = tests::solve(d.H, d.b);

  l.system.damp(lambda);
  ASSERT_TRUE(l.system.solve());
  EXPECT_LT((l.vector() - expected.head(p)).norm(), 2e-3 * expected.head(p).norm());
  std::vector<float> points(static_cast<std::size_t>(3 * scene.window.landmarks));
  step_points<Native>(scene.fc, scene.window, l.records, l.system,
                      {points.data(), static_cast<int>(points.size())});
  VectorXd steps(points.size());
  for (int i = 0; i < steps.size(); ++i)
    steps(i) = static_cast<double>(points[static_cast<std::size_t>(i)]) -
               static_cast<double>(scene.window.state.points[i]);
  EXPECT_LT((steps - expected.tail(steps.size())).norm(), 2e-3 * expected.norm());
}

TEST(NormalEquations, StepsAreThoseOfTheDenseSystem) { expect_steps_of_the_dense_system(true); }
TEST(NormalEquations, StepsAreThoseOfTheDenseSystemWithoutImu) {
  expect_steps_of_the_dense_system(false);
}

double smallest_eigenvalue(const MatrixXd& S) {
  // Scaled to a unit diagonal, in which Cholesky sees the matrix.
  const VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  return tests::symmetric_eigen(scale.asDiagonal() * S * scale.asDiagonal()).values(0);
}

TEST(NormalEquations, ReducedSystemIsPositiveDefinite) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OptimiserSceneOptions options;
    options.seed = seed;
    GraphScene scene(options);
    EXPECT_GT(smallest_eigenvalue(Linearised(scene, 1e-4f, true).matrix()), 0) << "start";
    scene.optimise(6);
    EXPECT_GT(smallest_eigenvalue(Linearised(scene, 1e-4f, true).matrix()), 0) << "solution";
  }
}

/// The mistake that PARAMETERS.md warns of would show.
TEST(NormalEquations, InertialTermOfTheWrongSignIsNotPositiveDefinite) {
  GraphScene scene;
  const MatrixXd visual = Linearised(scene, 1e-4f, true, {true, false, true}).matrix();
  const MatrixXd inertial = Linearised(scene, 1e-4f, true, {false, true, false}).matrix();
  EXPECT_GT(tests::symmetric_eigen(visual + inertial).values(0), 0);
  EXPECT_LT(tests::symmetric_eigen(visual - inertial).values(0), -1);
}

/// Whitened rows of an interval are JᵀΣ⁻¹J, here by finite differences of the inertial cost along
/// random directions: gradient and curvature at a small residual.
TEST(NormalEquations, InertialTermIsTheSlopeOfItsCost) {
  GraphScene scene;
  const Linearised l(scene, 0, true, {false, true, false});
  TestRandom random(5);
  const WindowState<Native>& at = scene.window.state;
  std::vector<float> poses(8 * kPoseFloats), velocities(8 * 3);
  const WindowState<Native> moved{{poses.data(), 96}, {velocities.data(), 24}, at.points};
  for (int trial = 0; trial < 10; ++trial) {
    VectorXd direction(72);
    for (int i = 0; i < 72; ++i) direction(i) = random.normal();
    const double h = 2e-3;
    double cost[2];
    for (int side = 0; side < 2; ++side) {
      const VectorXd step = direction * (side == 0 ? -h : h);
      for (int k = 0; k < 8; ++k) {
        KeyframeState<Native> s = at.keyframe(k);
        s.T_world_camera.R =
            to_mat3<Native>(to_eigen<Native>(s.T_world_camera.R) * exp_of(step.segment<3>(9 * k)));
        s.T_world_camera.t = s.T_world_camera.t + to_vec3<Native>(step.segment<3>(9 * k + 3));
        s.velocity = s.velocity + to_vec3<Native>(step.segment<3>(9 * k + 6));
        moved.set_keyframe(k, s);
      }
      cost[side] = static_cast<double>(inertial_cost<Native>(scene.window, moved, l.interval));
    }
    const double slope = (cost[1] - cost[0]) / (2 * h);
    const double scale = l.vector().norm() * direction.norm();
    EXPECT_NEAR(-l.vector().dot(direction), slope, 5e-3 * scale);
  }
}

TEST(NormalEquations, LandmarksBehindTheCamerasTakeNoPart) {
  GraphScene scene;
  const Linearised all(scene, 1e-4f, true);
  EXPECT_EQ(all.use.landmarks, scene.window.landmarks);
  for (int i = 0; i < 10; ++i) scene.window.state.points[3 * i + 2] = -5.0f;
  Linearised fewer(scene, 1e-4f, true);
  EXPECT_EQ(fewer.use.landmarks, scene.window.landmarks - 10);
  fewer.system.damp(1e-4f);
  ASSERT_TRUE(fewer.system.solve());
  std::vector<float> points(static_cast<std::size_t>(3 * scene.window.landmarks));
  step_points<Native>(scene.fc, scene.window, fewer.records, fewer.system,
                      {points.data(), static_cast<int>(points.size())});
  for (int i = 0; i < 30; ++i)
    EXPECT_EQ(points[static_cast<std::size_t>(i)], scene.window.state.points[i]);
  EXPECT_NE(points[30], scene.window.state.points[30]);
}

TEST(NormalEquations, UntouchedUnknownsStayWhereTheyAre) {
  GraphScene scene;
  // No inertial term: no residual touches the velocities.
  Linearised l(scene, 1e-4f, true, {true, false, true});
  l.system.damp(1e-4f);
  ASSERT_TRUE(l.system.solve());
  for (int k = 0; k < 8; ++k)
    for (int c = 6; c < 9; ++c) EXPECT_EQ(l.system.vector()[9 * k + c], 0.0f);
}

}  // namespace
}  // namespace leviosim::vio::test
