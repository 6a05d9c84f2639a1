// Distributions of a run's inputs, and of the iterations of its hypotheses.
#include "sim/work/op.h"
#include "tools/app/validation/distributions.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "tests/validation/example_log.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;
using work::Op;

TEST(InputDistributions, PercentilesAreLinearBetweenOrderStatistics) {
  std::vector<double> samples;
  for (int i = 10; i >= 0; --i) samples.push_back(i);
  EXPECT_EQ(distribution_of(samples), (Distribution{5, 1, 5, 9, 10}));
  EXPECT_EQ(distribution_of({1, 2}), (Distribution{1.5, 1.1, 1.5, 1.9, 2}));
  EXPECT_EQ(distribution_of({7}), (Distribution{7, 7, 7, 7, 7}));
  EXPECT_EQ(distribution_of({}), std::nullopt);
}

const InputDistribution& row(const std::vector<InputDistribution>& rows, std::string_view name) {
  for (const InputDistribution& row : rows)
    if (row.quantity == name) return row;
  ADD_FAILURE() << name;
  return rows.front();
}

TEST(InputDistributions, AreOfTheFramesAfterTheFirst) {
  const std::vector<InputDistribution> rows = input_distributions(testing::example_log());
  const InputDistribution& keypoints = row(rows, "keypoints of a frame");
  EXPECT_EQ(keypoints.released[0], 361);
  EXPECT_NEAR(*keypoints.simulated[0], (200 + 300 + 200) / 3.0, 1e-9);
  EXPECT_EQ(keypoints.simulated[4], 300);
  const InputDistribution& share = row(rows, "frames with 8-point");
  EXPECT_NEAR(*share.simulated[0], 200 / 3.0, 1e-9);
  EXPECT_EQ(share.simulated[1], std::nullopt);  // of shares there is a mean only
  EXPECT_EQ(row(rows, "8-point: rotations of a hypothesis").simulated[0], std::nullopt);
}

work::Segment hypothesis(std::uint64_t rotations, std::uint64_t steps) {
  work::Segment segment;
  segment[Op::F64Mul] = 2 * rotations;
  segment[Op::F32Div] = rotations + 21 + 54 * steps;
  return segment;
}

TEST(InputDistributions, OfIterationsAreCountedInEachHypothesis) {
  RansacSamples samples;
  const work::Fork epnp{"solve EPnP", {hypothesis(140, 0), hypothesis(5, 0), {}}};
  const work::Fork eight{"8-point hypotheses", {hypothesis(7, 4), hypothesis(8, 15)}};
  const work::Fork other{"8-point scoring", {hypothesis(7, 4)}};
  samples.add({{{"EPnP RANSAC", {epnp}, {}}, {"8-point RANSAC", {eight, other, eight}, {}}}});
  EXPECT_EQ(samples.epnp_rotations, (std::vector<double>{140, 5}));
  EXPECT_EQ(samples.eight_point_rotations, (std::vector<double>{7, 8, 7, 8}));
  EXPECT_EQ(samples.eight_point_steps, (std::vector<double>{4, 15, 4, 15}));
  EXPECT_EQ(samples.slowest_of_eight, (std::vector<double>{15, 15}));
}

TEST(InputDistributions, FaultsOfAPublishedFileNameTheLine) {
  const FrameLog log = testing::example_log();
  const auto refuse = [&](const std::string& row, std::initializer_list<std::string> parts) {
    const std::string titles = "quantity,mean,p10,median,p90,max\n";
    expect_input_error([&] { input_distributions("a.csv", titles + row, log); }, parts);
  };
  refuse("keypoints of a fram,1,,,,\n", {"a.csv", "line 2", "keypoints of a frame"});
  refuse("keyframes,x,,,,\n", {"a.csv", "line 2", "x"});
}

}  // namespace
}  // namespace leviosim::tools
