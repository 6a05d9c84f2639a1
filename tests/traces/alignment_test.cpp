// Closed-form alignment against known transforms and against a search for something better.
#include "traces/trajectories/trajectory_alignment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/traces/test_folder.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points random_points(std::uint64_t seed, std::size_t count) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(rng.uniform(-3, 3), rng.uniform(-2, 2), rng.uniform(-1, 1));
  return points;
}

Points transformed(const Points& points, const Similarity& by) {
  Points result;
  for (const Eigen::Vector3d& point : points) result.push_back(by * point);
  return result;
}

Similarity known(Alignment alignment) {
  Similarity s;
  s.translation = {1, -2, 3};
  s.rotation = alignment == Alignment::posyaw
                   ? Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()).toRotationMatrix()
                   : Eigen::AngleAxisd(2.5, Eigen::Vector3d(2, -1, 2) / 3).toRotationMatrix();
  if (alignment == Alignment::sim3) s.scale = 0.37;
  return s;
}

double cost(const Points& from, const Points& to, const Similarity& s) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (s * from[i] - to[i]).squaredNorm();
  return sum;
}

/// `s` changed a little along degree of freedom k: translation, rotation about z, x, y, scale.
Similarity nudged(Similarity s, int k, double by) {
  if (k < 3) s.translation[k] += by;
  if (k >= 3 && k < 6) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit((k - 3 + 2) % 3);
    s.rotation = Eigen::AngleAxisd(by, axis).toRotationMatrix() * s.rotation;
  }
  if (k == 6) s.scale *= 1 + by;
  return s;
}

int freedoms(Alignment alignment) {
  return alignment == Alignment::posyaw ? 4 : alignment == Alignment::se3 ? 6 : 7;
}

class AlignmentKinds : public ::testing::TestWithParam<Alignment> {};

TEST_P(AlignmentKinds, RecoversAKnownTransform) {
  const Similarity truth = known(GetParam());
  const Points from = random_points(1, 50);
  const Similarity found = align_points(from, transformed(from, truth), GetParam());
  EXPECT_NEAR(found.scale, truth.scale, 1e-12);
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-12);
  EXPECT_LT((found.translation - truth.translation).norm(), 1e-12);
}

TEST_P(AlignmentKinds, NoSmallStepIsBetter) {
  const Points from = random_points(2, 30);
  Points to = transformed(from, known(GetParam()));
  const Points noise = random_points(3, 30);
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += 0.2 * noise[i];
  const Similarity best = align_points(from, to, GetParam());
  const double least = cost(from, to, best);
  EXPECT_GT(least, 1.0) << "the noise must matter";
  for (int k = 0; k < freedoms(GetParam()); ++k) {
    for (const double step : {1e-4, 1e-2, 0.3}) {
      EXPECT_GT(cost(from, to, nudged(best, k, step)), least) << k << " " << step;
      EXPECT_GT(cost(from, to, nudged(best, k, -step)), least) << k << " " << -step;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, AlignmentKinds,
                         ::testing::Values(Alignment::se3, Alignment::sim3, Alignment::posyaw),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

TEST(AlignPoints, NeverMirrors) {
  // A mirror image: the best rotation is still a rotation.
  const Points from = random_points(4, 40);
  Points to = from;
  for (Eigen::Vector3d& point : to) point.x() = -point.x();
  for (const Alignment alignment : {Alignment::se3, Alignment::sim3})
    EXPECT_NEAR(align_points(from, to, alignment).rotation.determinant(), 1, 1e-12);
}

TEST(AlignPoints, TheScaleOfMirroredDataIsThatOfTheRotation) {
  // No rotation brings the two together: the smallest singular value counts against the scale.
  const Points from = random_points(7, 40);
  Points to = from;
  for (Eigen::Vector3d& point : to) point = 2 * Eigen::Vector3d(-point.x(), point.y(), point.z());
  const Similarity best = align_points(from, to, Alignment::sim3);
  EXPECT_LT(best.scale, 1.9) << "the mirror image itself would have 2";
  const double least = cost(from, to, best);
  for (int k = 0; k < freedoms(Alignment::sim3); ++k)
    for (const double step : {1e-3, -1e-3, 0.2, -0.2})
      EXPECT_GT(cost(from, to, nudged(best, k, step)), least) << k << " " << step;
}

TEST(AlignPoints, NoneIsTheIdentity) {
  const Similarity s = align_points({{1, 2, 3}}, {{4, 5, 6}}, Alignment::none);
  EXPECT_EQ(s.scale, 1);
  EXPECT_EQ(s.rotation, Eigen::Matrix3d::Identity());
  EXPECT_EQ(s.translation, Eigen::Vector3d::Zero());
}

TEST(AlignPoints, RefusesTooLittle) {
  const Points two = random_points(5, 2);
  testing::expect_input_error([&] { align_points(two, two, Alignment::se3); },
                              {"SE3", "at least 3", "are 2"});
  EXPECT_NO_THROW(align_points(two, two, Alignment::posyaw));
  const Points same(5, Eigen::Vector3d(1, 2, 3));
  testing::expect_input_error([&] { align_points(same, random_points(6, 5), Alignment::sim3); },
                              {"Sim3", "coincide"});
}

/// Their covariance is infinite, and the SVD of that leaves whatever memory held.
TEST(AlignPoints, RefusesPositionsWhoseSquaresAreNoNumbers) {
  const Points huge = {{1e308, 0, 0}, {0, 0, 0}, {-1e308, 0, 0}};
  const Points truth = {{0, 1, 2}, {2, 1, 2}, {4, 1, 2}};
  for (const Alignment kind : {Alignment::posyaw, Alignment::se3, Alignment::sim3})
    EXPECT_THROW(align_points(huge, truth, kind), NotComparable) << name_of(kind);
}

TEST(Alignment, NamesParse) {
  EXPECT_EQ(parse_alignment("posyaw"), Alignment::posyaw);
  EXPECT_EQ(parse_alignment("none"), Alignment::none);
  EXPECT_EQ(parse_alignment("se3"), Alignment::se3);
  EXPECT_EQ(parse_alignment("sim3"), Alignment::sim3);
  testing::expect_input_error([] { parse_alignment("SE(3)"); },
                              {"'SE(3)'", "none, se3, sim3, posyaw"});
}

}  // namespace
}  // namespace leviosim::traces
