#include "traces/synthesis/frame_stamps.h"

#include <gtest/gtest.h>

namespace leviosim::traces {
namespace {

TEST(FrameStamps, RegularStampsDoNotDrift) {
  const StampList stamps = regular_stamps(1000, 1'000'001'000, 30);
  ASSERT_EQ(stamps.size(), 31u);
  EXPECT_EQ(stamps[0], 1000);
  EXPECT_EQ(stamps[1], 33'334'333);
  EXPECT_EQ(stamps[30], 1'000'001'000);
}

TEST(FrameStamps, BothEndsOfTheSpanCount) {
  EXPECT_EQ(stamps_within({1, 2, 3, 4}, {2, 3}), (StampList{2, 3}));
  EXPECT_EQ(stamps_within({1, 2}, {3, 9}), StampList{});
}

TEST(FrameStamps, FramesFollowTheJitteringGrid) {
  // Every 5 ns, but some are missing (so 45 is taken at 50) and one is late (81).
  const StampList grid{0, 5, 10, 20, 25, 30, 40, 50, 55, 65, 70, 81, 85, 95, 100};
  EXPECT_EQ(stamps_nearest_to_period(grid, {4, 99}, 20), (StampList{5, 25, 50, 65, 85}));
  EXPECT_EQ(stamps_nearest_to_period(grid, {101, 200}, 20), StampList{});
}

}  // namespace
}  // namespace leviosim::traces
