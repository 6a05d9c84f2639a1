#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_samples.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"

namespace leviosim::traces {
namespace {

using testing::AslFolder;

TEST(ImuBatches, EveryFrameHasTheSamplesSinceTheOneBefore) {
  const AslFolder folder;
  const Dataset data = open_asl(folder.root());
  for (std::size_t i = 0; i < data.frames.size(); ++i) {
    const auto batch = imu_batch(data, i);
    ASSERT_EQ(batch.size(), 10u);
    EXPECT_EQ(batch.back().t_ns, data.frames[i].t_ns);
    EXPECT_EQ(batch.front().t_ns, data.frames[i].t_ns - 45'000'000);
  }
}

TEST(ImuBatches, GrowWhereAFrameIsMissing) {
  const AslFolder folder;
  folder.remove_lines("cam0/data.csv", 4, 1);
  EXPECT_EQ(imu_batch(open_asl(folder.root()), 2).size(), 20u);
}

TEST(ImuBatches, RecordedFlightHasTenPerFrame) {
  const auto folder = testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const Dataset data = open_asl(folder);
  for (std::size_t i = 0; i < data.frames.size(); ++i) ASSERT_EQ(imu_batch(data, i).size(), 10u);
}

TEST(ImuBatches, BetweenExcludesTheStartAndIncludesTheEnd) {
  std::vector<ImuSample> samples(3);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].t_ns = 10 * static_cast<std::int64_t>(i + 1);
  EXPECT_EQ(imu_between(samples, 10, 30).size(), 2u);
  EXPECT_EQ(imu_between(samples, 9, 29).size(), 2u);
  EXPECT_TRUE(imu_between(samples, 30, 99).empty());
  EXPECT_TRUE(imu_between(samples, 20, 20).empty());
}

TEST(ImuBatches, InterpolatesLinearly) {
  const std::vector<ImuSample> samples{{10, {1, 2, 3}, {0, 0, 0}}, {20, {2, 4, 6}, {1, 1, 1}}};
  EXPECT_TRUE(interpolate_imu(samples, 13).gyro.isApprox(Eigen::Vector3d(1.3, 2.6, 3.9)));
  EXPECT_TRUE(interpolate_imu(samples, 13).accel.isApprox(Eigen::Vector3d(0.3, 0.3, 0.3)));
  EXPECT_EQ(interpolate_imu(samples, 10).gyro, samples[0].gyro);
  EXPECT_EQ(interpolate_imu(samples, 20).gyro, samples[1].gyro);
  testing::expect_input_error([&] { interpolate_imu(samples, 9); }, {"9 ns"});
  testing::expect_input_error([&] { interpolate_imu(samples, 21); }, {"21 ns"});
}

}  // namespace
}  // namespace leviosim::traces
