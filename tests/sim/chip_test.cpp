// The chip as a whole: clocks of its parts.
#include "sim/chip/chip.h"

#include <gtest/gtest.h>

#include "sim/work/op.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {
namespace {

/// Cycles that the cluster's master takes for the steps, at so many cycles per one of the SoC.
double cluster_cycles(int clock_ratio, std::vector<work::Step> steps) {
  ChipConfig config = test_chip();
  config.controller.clock = Hertz(100'000'000);
  config.cluster.clock = Hertz(100'000'000) * clock_ratio;
  config.cluster.core.ops[work::index(work::Op::LoadL2)] = {1, 14, Unit::Core};
  config.cluster.icache = {.line = Bytes(16),
                           .worker = Bytes(512),
                           .master = Bytes(512),
                           .shared = Bytes(4096),
                           .shared_banks = 2,
                           .shared_hit = 2,
                           .shared_miss = 18,
                           .refill_width = 8};
  Chip chip(config, 8);
  JobTiming timing;
  const work::Job job{{{"stage", std::move(steps), {}}}};
  const auto body = [&]() -> Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  return static_cast<double>(timing.stages[0].cycles.count());
}

/// What the cluster waits for L2 lasts as long whatever its own clock
/// (FACTS.md#l2-and-interconnect).
TEST(Chip, WaitsForL2TakeTheirTimeOnTheClockOfTheSoc) {
  constexpr std::uint64_t kLines = 100, kLoads = 50;
  work::Counts code;
  code.code[work::kNeverFetched] = 16 * kLines;
  work::Counts loads;
  loads[work::Op::LoadL2] = kLoads;
  for (const int ratio : {1, 2, 3}) {
    EXPECT_DOUBLE_EQ(cluster_cycles(ratio, {work::Serial{{code}}}), 20 * kLines * ratio);
    EXPECT_DOUBLE_EQ(cluster_cycles(ratio, {work::Serial{{loads}}}), kLoads * (1 + 14 * ratio));
  }
}

/// 8 bytes per cycle of the SoC, and its latency on the same clock.
TEST(Chip, TransfersTakeTheirTimeOnTheClockOfTheSoc) {
  const auto transfer = [](std::int64_t bytes) {
    return work::Transfer{work::Direction::L2ToL1, Bytes(bytes)};
  };
  for (const int ratio : {1, 2, 4}) {
    const double bytes_8000 = cluster_cycles(ratio, {transfer(8000)});
    EXPECT_NEAR(cluster_cycles(ratio, {transfer(16000)}) - bytes_8000, 1000 * ratio, 1);
  }
}

/// The core's own work is counted in its own cycles.
TEST(Chip, WorkInLocalMemoryTakesTheSameCyclesAtAnyClock) {
  for (const int ratio : {1, 2, 5})
    EXPECT_DOUBLE_EQ(cluster_cycles(ratio, {work::Serial{{alu(1000)}}}), 1000);
}

}  // namespace
}  // namespace leviosim::sim
