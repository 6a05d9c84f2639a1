#include "tests/workload/inertial/preintegration_double.h"
//
#include <gtest/gtest.h>

#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/graph/reprojection.h"

namespace leviosim::vio::test {
namespace {

using Double = DoublePolicy;

struct View {
  Matrix3d R = exp_of({0.3, -0.2, 0.5});
  Vector3d t{0.4, -0.1, 0.2};
  Vector3d point = R * Vector3d(0.4, -0.3, 2.5) + t;
  Vec2<Double> observed{95.8, 48.6};
  PixelModel<Double> model{ReprojectionOptions{}};

  Projection<Double> at(const Matrix3d& R_now, const Vector3d& t_now, const Vector3d& x) const {
    Projection<Double> result;
    const Vec3<Double> in_camera = to_vec3<Double>(R_now.transpose() * (x - t_now));
    EXPECT_TRUE(project<Double>(model, in_camera, observed, result));
    return result;
  }
  Projection<Double> at() const { return at(R, t, point); }
};

Eigen::Vector2d error(const Projection<Double>& p) { return {p.error.x, p.error.y}; }

/// Central differences of the error, times `weight`.
template <class Move>
Eigen::Matrix<double, 2, 3> differences(double weight, Move move) {
  const double h = 1e-6;
  Eigen::Matrix<double, 2, 3> J;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = h * Vector3d::Unit(i);
    J.col(i) = weight * (error(move(step)) - error(move(-step))) / (2 * h);
  }
  return J;
}
Eigen::Matrix<double, 2, 3> two_rows(const Vec3<Double> (&rows)[2]) {
  Eigen::Matrix<double, 2, 3> J;
  J.row(0) = to_eigen<Double>(rows[0]).transpose();
  J.row(1) = to_eigen<Double>(rows[1]).transpose();
  return J;
}

void expect_derivatives(const View& v) {
  const VisualTerm<Double> term = linearise<Double>(v.model, to_mat3<Double>(v.R), v.at());
  const double weight = root_weight<Double>(v.model, v.at().error_sq);
  const auto by_rotation =
      differences(weight, [&](const Vector3d& w) { return v.at(v.R * exp_of(w), v.t, v.point); });
  const auto by_position =
      differences(weight, [&](const Vector3d& d) { return v.at(v.R, v.t + d, v.point); });
  const auto by_point =
      differences(weight, [&](const Vector3d& d) { return v.at(v.R, v.t, v.point + d); });
  EXPECT_LT((two_rows(term.by_rotation) - by_rotation).norm(), 1e-6 * by_rotation.norm());
  EXPECT_LT((two_rows(term.by_point) - by_point).norm(), 1e-6 * by_point.norm());
  EXPECT_LT((two_rows(term.by_point) + by_position).norm(), 1e-6 * by_point.norm());
  EXPECT_NEAR(term.residual[0], weight * error(v.at()).x(), 1e-12);
  EXPECT_NEAR(term.residual[1], weight * error(v.at()).y(), 1e-12);
}

TEST(Reprojection, DerivativesOfAnInlier) {
  const View v;
  ASSERT_LT(error(v.at()).norm(), 1);
  expect_derivatives(v);
}

TEST(Reprojection, DerivativesOfAnOutlierAreWeighted) {
  View v;
  v.observed = {107, 42};
  ASSERT_GT(error(v.at()).norm(), 10);
  expect_derivatives(v);
}

TEST(Reprojection, WeightedResidualGivesTheGradientOfTheHuberCost) {
  for (const double x : {0.3, 0.9, 1.1, 5.0, 40.0}) {
    ReprojectionOptions options;
    options.sigma_px = 0.7f;
    const PixelModel<Double> model(options);
    const double h = 1e-6;
    const double slope = (huber_cost<Double>(model, (x + h) * (x + h)) -
                          huber_cost<Double>(model, (x - h) * (x - h))) /
                         (2 * h);
    const double weight = root_weight<Double>(model, x * x);
    EXPECT_NEAR(weight * weight * x, slope, 1e-6 * slope) << x;
  }
}

TEST(Reprojection, HuberCostIsQuadraticThenLinear) {
  const PixelModel<Double> model{ReprojectionOptions{}};
  EXPECT_DOUBLE_EQ(huber_cost<Double>(model, 0.25), 0.125);
  EXPECT_DOUBLE_EQ(huber_cost<Double>(model, 1), 0.5);
  EXPECT_DOUBLE_EQ(huber_cost<Double>(model, 25), 4.5);
  EXPECT_DOUBLE_EQ(model.lost_cost, huber_cost<Double>(model, 40 * 40));
}

TEST(Reprojection, LosesPointsBehindTheCameraAndFarOff) {
  const PixelModel<Double> model{ReprojectionOptions{}};
  const auto seen = [&](const Vec3<Double>& in_camera, const Vec2<Double>& observed) {
    Projection<Double> at;
    return project<Double>(model, in_camera, observed, at);
  };
  const Vec2<Double> centre{model.cx, model.cy};
  EXPECT_TRUE(seen({0, 0, 1}, centre));
  EXPECT_TRUE(seen({0, 0, 0.051}, centre));
  EXPECT_FALSE(seen({0, 0, 0.049}, centre));
  EXPECT_FALSE(seen({0, 0, -1}, centre));
  EXPECT_TRUE(seen({0, 0, 1}, {model.cx + 39.9, model.cy}));
  EXPECT_FALSE(seen({0, 0, 1}, {model.cx + 30, model.cy - 30}));
}

}  // namespace
}  // namespace leviosim::vio::test
