// Upright attitudes, and intervals with the biases as unknowns.
#include <gtest/gtest.h>

#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/graph/joint_inertial_terms.h"
#include "workload/inertial/initialisation.h"

namespace leviosim::vio::test {
namespace {

using work::Native;

TEST(Upright, TheForcePointsUp) {
  for (const Vector3d& force : {Vector3d(0.3, -9.7, 1.0), Vector3d(0, 0.2, -9.8)}) {
    const Matrix3d R = to_eigen<Native>(upright_rotation<Native>(to_vec3<Native>(force)));
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-5);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-5);
    EXPECT_LT((R * force.normalized() - Vector3d::UnitZ()).norm(), 1e-5);
  }
}

TEST(Upright, LevellingTurnsNoMoreThanItMust) {
  const Vector3d force(0.3, -9.7, 1.0);
  const Matrix3d upright = to_eigen<Native>(upright_rotation<Native>(to_vec3<Native>(force)));
  const Matrix3d tilted = exp_of({0.1, -0.05, 0.0}) * upright;
  const Matrix3d R =
      to_eigen<Native>(levelled<Native>(to_mat3<Native>(tilted), to_vec3<Native>(force)));
  EXPECT_LT((R * force.normalized() - Vector3d::UnitZ()).norm(), 1e-5);
  EXPECT_LT((R - upright).norm(), 1e-3);
}

/// Central differences of the residual by one unknown of linearise_interval().
class JointInterval : public testing::Test {
 protected:
  JointInterval() { integrate<Native>(motion, 0.3, 0.6, 60, interval, ImuBias<Native>::zero()); }

  Eigen::VectorXd residual(const Eigen::VectorXd& x) const {
    work::Arena arena("scratch", Bytes(4096));
    const MatrixView<Native> rows = linearise(x, arena);
    Eigen::VectorXd r(9);
    for (int i = 0; i < 9; ++i) r[i] = static_cast<double>(rows(i, 24));
    return r;
  }
  MatrixView<Native> linearise(const Eigen::VectorXd& x, work::Arena& arena) const {
    const auto moved = [&](double t, int at) {
      KeyframeState<Native> state;
      state.T_world_camera.R = to_mat3<Native>(Motion::rotation(t) * exp_of({0.02, -0.03, 0.05}) *
                                               exp_of(x.segment<3>(at)));
      state.T_world_camera.t =
          to_vec3<Native>(Motion::position(t) + Vector3d(x.segment<3>(at + 3)));
      state.velocity = to_vec3<Native>(Motion::velocity(t) + Vector3d(x.segment<3>(at + 6)));
      return state;
    };
    const JointScratch<Native> scratch(arena);
    linearise_interval<Native>(
        interval, moved(0.3, 0), moved(0.6, 9),
        {to_vec3<Native>(x.segment<3>(18)), to_vec3<Native>(x.segment<3>(21))},
        to_vec3<Native>(motion.gravity), {0.1f, -0.05f, 0.07f}, scratch.rows);
    return scratch.rows;
  }

  Motion motion;
  OwnedInterval<Native> interval;
};

TEST_F(JointInterval, JacobiansAreThoseOfNumericalDifferences) {
  work::Arena arena("scratch", Bytes(4096));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(24);
  const MatrixView<Native> rows = linearise(zero, arena);
  const double h = 5e-3;  // single precision
  for (int c = 0; c < 24; ++c) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(24, c);
    const Eigen::VectorXd difference = (residual(zero + step) - residual(zero - step)) / (2 * h);
    for (int r = 0; r < 9; ++r)
      EXPECT_NEAR(static_cast<double>(rows(r, c)), difference[r], 2e-3) << r << ", " << c;
  }
}

}  // namespace
}  // namespace leviosim::vio::test
