// The time base: conversions are exact, and what cannot be exact is refused with the reason.
#include "sim/events/timebase.h"

#include <gtest/gtest.h>

#include <string>

#include "sim/base/error.h"

namespace leviosim::sim {
namespace {

Timebase gap9() {
  return Timebase({{"cluster", Hertz(370'000'000)}, {"fabric", Hertz(240'000'000)}});
}

/// Ticks of a second.
std::int64_t tick_rate(const Timebase& timebase) {
  return timebase.from_nanoseconds(1'000'000'000).count();
}

std::string refusal(const std::vector<ClockSpec>& clocks) {
  try {
    const Timebase timebase(clocks);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Timebase, TickRateIsTheLeastCommonMultiple) {
  EXPECT_EQ(tick_rate(Timebase({})), 1'000'000'000);
  EXPECT_EQ(tick_rate(Timebase({{"c", Hertz(370'000'000)}})), 37'000'000'000);
  EXPECT_EQ(tick_rate(gap9()), 222'000'000'000);
}

TEST(Timebase, PeriodsAreWholeTicks) {
  const Timebase timebase = gap9();
  EXPECT_EQ(timebase.clock("cluster").period(), Duration(600));
  EXPECT_EQ(timebase.clock("fabric").period(), Duration(925));
  EXPECT_EQ(timebase.clock("fabric").frequency(), Hertz(240'000'000));
}

TEST(Timebase, ExactAfterABillionCycles) {
  const Timebase timebase = gap9();
  const ClockDomain& cluster = timebase.clock("cluster");
  const ClockDomain& fabric = timebase.clock("fabric");
  // 37 cycles at 370 MHz, 24 cycles at 240 MHz and 100 ns are the same duration.
  EXPECT_EQ(cluster.duration(Cycles(37)), fabric.duration(Cycles(24)));
  EXPECT_EQ(cluster.duration(Cycles(37)), timebase.from_nanoseconds(100));
  const Cycles billion_cluster(1'000'000'000 / 37 * 37);
  const Cycles billion_fabric(1'000'000'000 / 37 * 24);
  EXPECT_EQ(cluster.duration(billion_cluster), fabric.duration(billion_fabric));
  EXPECT_EQ(cluster.whole_cycles(fabric.duration(billion_fabric)), billion_cluster);
  // A billion single steps end exactly where one long step does.
  EXPECT_EQ(cluster.duration(Cycles(1)).count() * 1'000'000'000,
            cluster.duration(Cycles(1'000'000'000)).count());
  EXPECT_EQ(timebase.seconds(cluster.duration(Cycles(370'000'000))), 1.0);
  EXPECT_EQ(timebase.seconds(fabric.duration(Cycles(240'000'000))), 1.0);
}

TEST(Timebase, NanosecondsComeBackExactly) {
  const Timebase timebase = gap9();
  for (const std::int64_t ns : {0LL, 1LL, 49'999'872LL, 3'600'000'000'007LL, -1LL, -12'345LL}) {
    const Duration ticks = timebase.from_nanoseconds(ns);
    EXPECT_EQ(timebase.whole_nanoseconds(ticks), ns);
    EXPECT_EQ(timebase.whole_nanoseconds(ticks - Duration(1)), ns - 1);
    EXPECT_EQ(timebase.whole_nanoseconds(ticks + Duration(221)), ns);
  }
}

TEST(Timebase, CyclesAreRoundedDown) {
  const Timebase timebase = gap9();
  const ClockDomain& cluster = timebase.clock("cluster");
  const Duration seven = cluster.duration(Cycles(7));
  EXPECT_EQ(cluster.whole_cycles(seven), Cycles(7));
  EXPECT_EQ(cluster.whole_cycles(seven - Duration(1)), Cycles(6));
  EXPECT_EQ(cluster.whole_cycles(seven + Duration(1)), Cycles(7));
}

TEST(Timebase, RefusesClocksWithoutACommonTick) {
  const std::string message =
      refusal({{"cluster", Hertz(369'999'999)}, {"fabric", Hertz(240'000'001)}});
  EXPECT_NE(message.find("cluster 369999999 Hz"), std::string::npos) << message;
  EXPECT_NE(message.find("fabric 240000001 Hz"), std::string::npos) << message;
  EXPECT_NE(message.find("1 ns"), std::string::npos) << message;
}

TEST(Timebase, AcceptsWhatLastsAnHourAndNoMore) {
  // The bound is 2562047 * 1e9 and some: 2562047 Hz shares no factor with 1e9, nor does 2562049 Hz.
  const Timebase largest({{"odd", Hertz(2'562'047)}});
  EXPECT_EQ(tick_rate(largest), 2'562'047'000'000'000);
  EXPECT_EQ(largest.from_nanoseconds(3'600'000'000'000).count(), 9'223'369'200'000'000'000);
  EXPECT_NE(refusal({{"odd", Hertz(2'562'049)}}), "");
}

TEST(Timebase, RefusesBadClocks) {
  EXPECT_NE(refusal({{"cluster", Hertz(0)}}).find("'cluster': frequency 0 Hz"), std::string::npos);
  EXPECT_NE(refusal({{"cluster", Hertz(-5)}}).find("-5 Hz"), std::string::npos);
  EXPECT_NE(refusal({{"", Hertz(1)}}), "");
  EXPECT_NE(refusal({{"a", Hertz(1)}, {"b", Hertz(1)}, {"a", Hertz(2)}}).find("'a' is given twice"),
            std::string::npos);
}

TEST(Timebase, RefusesAbsoluteTimestamps) {
  EXPECT_THROW(gap9().from_nanoseconds(1'403'636'584'763'555'584), InputError);
}

TEST(Timebase, UnknownClockNamesTheKnown) {
  try {
    const Timebase timebase = gap9();
    timebase.clock("clutser");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "unknown clock 'clutser'; the clocks are: cluster, fabric");
  }
}

TEST(Timebase, RefusesCyclesBeyondTheRange) {
  const Timebase timebase = gap9();
  EXPECT_THROW(timebase.clock("cluster").duration(Cycles(std::int64_t{1} << 60)), InputError);
}

}  // namespace
}  // namespace leviosim::sim
