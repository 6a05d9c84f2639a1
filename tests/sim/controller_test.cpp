// The fabric controller's transfers from memory outside of the chip, and its clock edges.
#include "sim/chip/controller.h"

#include <gtest/gtest.h>

#include "sim/chip/chip.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {
namespace {

/// Cycles of a stage at 100 MHz, with external memory of 1 GB/s, 1 µs and bursts of 64 bytes.
Cycles cycles_of(std::vector<work::Step> steps) {
  ChipConfig config = test_chip();
  config.controller.clock = Hertz(100'000'000);
  config.controller.external = {1e-6, 1e9, Bytes(64)};
  Chip chip(config, 8);
  JobTiming timing;
  const work::Job job{{{"stage", std::move(steps), {}}}};
  const auto body = [&]() -> Process { timing = co_await chip.controller().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  return timing.stages[0].cycles;
}

work::Transfer external(std::int64_t bytes) {
  return {work::Direction::ExternalToL2, Bytes(bytes)};
}

TEST(Controller, ATransferFromExternalMemoryTakesABurstAtLeast) {
  // A byte takes a tenth of a cycle; stages end on the next clock edge.
  EXPECT_EQ(cycles_of({external(10'004)}), Cycles(100 + 1001));
  EXPECT_EQ(cycles_of({external(644)}), Cycles(100 + 65));
  EXPECT_EQ(cycles_of({external(64)}), Cycles(100 + 7));
  EXPECT_EQ(cycles_of({external(1)}), Cycles(100 + 7));
  EXPECT_EQ(cycles_of({external(644), external(644)}), Cycles(200 + 129));
}

work::Transfer in_background(work::Direction direction, std::int64_t bytes) {
  return {direction, Bytes(bytes), true};
}
work::Serial work_of(std::uint64_t cycles) { return {{alu(cycles), {}}}; }

TEST(Controller, DataPassWhileItWorksAndLatencyKeepsItBusy) {
  using enum work::Direction;
  const work::Transfer in = in_background(ExternalToL2, 10'000);  // 100 cycles and 1000
  // As long as the work is longer, only the latency shows; else what is left of the data.
  EXPECT_EQ(cycles_of({in, work_of(1500), work::TransferWait{0}}), Cycles(100 + 1500));
  EXPECT_EQ(cycles_of({in, work_of(400), work::TransferWait{0}}), Cycles(100 + 1000));
  // Data pass one after the other, those that nobody waits for yet, too.
  const work::Transfer out = in_background(L2ToExternal, 10'000);
  EXPECT_EQ(cycles_of({in, out, work::TransferWait{0}, work::TransferWait{1}}),
            Cycles(100 + 1000 + 1000));
  EXPECT_EQ(cycles_of({in, out, work::TransferWait{0}, work_of(2000), work::TransferWait{1}}),
            Cycles(100 + 1000 + 2000));
}

TEST(Controller, TransfersInsideTheChipAreNotFar) {
  EXPECT_EQ(cycles_of({work::Transfer{work::Direction::L2ToL1, Bytes(10'000)}}), Cycles(0));
}

}  // namespace
}  // namespace leviosim::sim
