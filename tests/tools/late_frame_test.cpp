// Which frames are held against each other, and how both are drawn.
#include "tools/app/why/late_frame.h"

#include <gtest/gtest.h>

namespace leviosim::tools {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// Frames of these own times in ms, 10 ms apart; each waits until the one before is done.
std::vector<FrameResult> frames_of(const std::vector<int>& own_ms) {
  std::vector<FrameResult> frames;
  std::int64_t free = 0;
  for (std::size_t i = 0; i < own_ms.size(); ++i) {
    FrameResult& frame = frames.emplace_back();
    frame.arrival_ns = static_cast<std::int64_t>(i) * 10 * kMs;
    frame.start_ns = std::max(free, frame.arrival_ns);
    frame.end_ns = free = frame.start_ns + own_ms[i] * kMs;
  }
  return frames;
}

ExplainedFrame explained(int number, double waited_ms, std::vector<StageSpan> stages) {
  ExplainedFrame frame;
  frame.number = number;
  frame.waited_ms = waited_ms;
  frame.own_ms = stages.back().end_ms - waited_ms;
  frame.stages = std::move(stages);
  return frame;
}

TEST(LateFrame, TheMedianIsOfOwnTimesAndTheSlowestOfLatencies) {
  const std::vector<FrameResult> frames = frames_of({9, 25, 8, 7, 3});
  EXPECT_EQ(median_frame(frames), 2);
  EXPECT_EQ(slowest_frame(frames), 1);
  // Frame 2 is quick, but waits for frame 1.
  EXPECT_EQ(slowest_frame(frames_of({9, 18, 17, 7})), 2);
  EXPECT_EQ(median_frame(frames_of({4, 3})), 1) << "the lower one of two";
}

TEST(LateFrame, BarsShowStagesAndWaitingOnOneAxis) {
  const ExplainedFrame median = explained(1, 0, {{"feature extraction", 0, 4}, {"EPnP", 4, 8}});
  const ExplainedFrame late = explained(12, 2, {{"feature extraction", 2, 6}, {"EPnP", 6, 16}});
  const std::string bars = frame_bars(median, late, 8, 9 + 16);
  EXPECT_NE(bars.find("frame 1  FFFFEEEE        \n"), std::string::npos) << bars;
  EXPECT_NE(bars.find("frame 12 ..FFFFEEEEEEEEEE\n"), std::string::npos) << bars;
  EXPECT_NE(bars.find("F feature extraction"), std::string::npos) << bars;
}

TEST(LateFrame, AFrameBesideItselfDiffersInNothing) {
  const ExplainedFrame frame = explained(3, 0, {{"EPnP", 0, 8}});
  EXPECT_TRUE(fact_differences(frame, frame).empty());
  EXPECT_EQ(why_text(frame, frame, 10),
            "frame 3 was in time: its own work took 8.00 ms of 10; it is the median frame");
}

}  // namespace
}  // namespace leviosim::tools
