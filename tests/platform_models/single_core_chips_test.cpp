// Chips with one core besides the STM32F405: what is known of them, and how the rest is marked.
#include "platform_models/loader/parameter_units.h"
#include "sim/chip/cost.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

class SingleCoreChip : public ::testing::TestWithParam<const char*> {};

TEST_P(SingleCoreChip, DoesAllTheWorkOnOneCore) {
  const sim::ChipConfig chip = load_platform(GetParam());
  EXPECT_EQ(chip.cluster.max_workers, 1);
  EXPECT_TRUE(chip.controller.shares_core);
  EXPECT_EQ(chip.cluster.clock, chip.controller.clock);
  for (const work::OpInfo& info : work::kOps)
    EXPECT_EQ(chip.cluster.core[info.op].unit, sim::Unit::Core) << info.name;
}

TEST_P(SingleCoreChip, HasOneClock) {
  EXPECT_THROW(resolve_platform(GetParam(), {"controller.clock=1MHz"}), InputError);
  EXPECT_NO_THROW(resolve_platform(GetParam(), {"controller.clock=1MHz", "cluster.clock=1MHz"}));
}

TEST_P(SingleCoreChip, EveryUncertainNumberHasARangeThatCanBeRun) {
  for (const Parameter& p : resolve_platform(GetParam()).parameters) {
    if (p.unit.empty() || p.confidence == "high") continue;
    ASSERT_TRUE(p.range) << p.path << " has confidence " << p.confidence << " and no range";
    for (const double end : {p.range->low, p.range->high})
      EXPECT_NO_THROW(load_platform(GetParam(), {p.path + "=" + number_text(end) + p.unit}))
          << p.path;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SingleCoreChip,
                         ::testing::Values("cortex-m7", "cortex-m7-h7a3", "arm1176"));

double cycles_of(const char* chip, work::Op op) {
  work::Counts counts;
  counts[op] = 1;
  return sim::demand_of(counts, load_platform(chip).cluster.core).cycles();
}

// FACTS.md#cortex-m7: 16 cycles; dual issue makes nothing slower.
TEST(CortexM7, IssuesTwoInstructionsPerCycle) {
  EXPECT_EQ(cycles_of("cortex-m7", work::Op::F32Div), 16);
  for (const work::Op op : {work::Op::IntAlu, work::Op::IntMinMax, work::Op::Popcount,
                            work::Op::StoreStream, work::Op::LoopIteration}) {
    EXPECT_LT(cycles_of("cortex-m7", op), cycles_of("cortex-m4f", op)) << work::index(op);
    EXPECT_GE(2 * cycles_of("cortex-m7", op), 1) << work::index(op);
  }
  // In hardware here, a routine there.
  EXPECT_LT(10 * cycles_of("cortex-m7", work::Op::F64Add),
            cycles_of("cortex-m4f", work::Op::F64Add));
}

// FACTS.md#cortex-m7: 310 mW at 216 MHz; 146 to 163 mW at 280 MHz.
TEST(CortexM7, EnergyIsThatOfMeasuredPower) {
  const sim::ChipConfig f7 = load_platform("cortex-m7");
  EXPECT_NEAR(f7.energy.value.soc.cycle.count() * 216e6, 0.310, 0.002);
  const sim::ChipConfig h7 = load_platform("cortex-m7-h7a3");
  EXPECT_NEAR(h7.energy.low.soc.cycle.count() * 280e6, 0.146, 0.001);
  EXPECT_NEAR(h7.energy.high.soc.cycle.count() * 280e6, 0.163, 0.001);
}

// FACTS.md#arm1176: throughput and latency of the VFP11; 0.54 W idle, 0.7 to 1 W busy.
TEST(Arm1176, FloatingPointLiesBetweenThroughputAndLatency) {
  for (const work::Op op : {work::Op::F32Add, work::Op::F32Mul, work::Op::F32Fma}) {
    EXPECT_GT(cycles_of("arm1176", op), 1);
    EXPECT_LT(cycles_of("arm1176", op), 8);
  }
  EXPECT_GE(cycles_of("arm1176", work::Op::F32Div), 15);
  EXPECT_LE(cycles_of("arm1176", work::Op::F32Div), 19);
  const sim::ChipConfig chip = load_platform("arm1176");
  const double idle = chip.energy.value.soc.static_power.count();
  EXPECT_NEAR(idle, 0.54, 1e-9);
  EXPECT_NEAR(idle + chip.energy.low.core.leakage.count(), 0.7, 0.001);
  EXPECT_NEAR(idle + chip.energy.high.core.leakage.count(), 1.0, 0.001);
}

}  // namespace
}  // namespace leviosim::platform
