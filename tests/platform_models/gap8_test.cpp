// GAP8: what is known of the chip, and how its uncertain numbers are marked.
#include "platform_models/loader/parameter_units.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

// FACTS.md#operating-points, FACTS.md#other-chips.
TEST(Gap8, StructureOfTheChip) {
  const sim::ChipConfig chip = load_platform("gap8");
  EXPECT_EQ(chip.name, "GAP8");
  EXPECT_EQ(chip.cluster.clock.count(), 175'000'000);
  EXPECT_EQ(chip.controller.clock.count(), 250'000'000);
  EXPECT_EQ(chip.cluster.workers, 8);
  EXPECT_EQ(chip.cluster.fpu.units, 0);
  EXPECT_EQ(chip.cluster.l1.size.count(), 64 * 1024);
  EXPECT_EQ(chip.cluster.icache.worker.count(), 0);
  EXPECT_EQ(chip.cluster.icache.shared.count(), 16 * 1024);
  EXPECT_EQ(chip.l2.size.count(), 512 * 1024);
}

TEST(Gap8, FloatingPointIsALibrary) {
  for (const sim::CoreConfig& core :
       {load_platform("gap8").cluster.core, load_platform("gap8").controller.core})
    for (const work::Op op : {work::Op::F32Add, work::Op::F32Mul, work::Op::F32Div,
                              work::Op::F32Sqrt, work::Op::F64Add}) {
      EXPECT_EQ(core[op].unit, sim::Unit::Core);
      EXPECT_TRUE(core[op].routine);
      EXPECT_GT(core[op].issue, 50);
    }
}

TEST(Gap8, EveryUncertainNumberHasARangeThatCanBeRun) {
  for (const Parameter& p : resolve_platform("gap8").parameters) {
    if (p.unit.empty() || p.confidence == "high") continue;
    ASSERT_TRUE(p.range) << p.path << " has confidence " << p.confidence << " and no range";
    for (const double end : {p.range->low, p.range->high})
      EXPECT_NO_THROW(load_platform("gap8", {p.path + "=" + number_text(end) + p.unit})) << p.path;
  }
}

// One task was measured on both chips (FACTS.md#published-power): 79 mW at 175 MHz, 20.5 mW at 240
// MHz.
TEST(Gap8, EnergiesAreThoseOfGap9TimesTheRatioOfAMeasuredTask) {
  const sim::EnergyConfig gap8 = load_platform("gap8").energy.value;
  const sim::EnergyConfig gap9 = load_platform("gap9").energy.value;
  const double per_cycle = (79.0 / 175) / (20.5 / 240);
  const double power = 79.0 / 20.5;
  const auto ratio = [](auto a, auto b) { return a.count() / b.count(); };
  EXPECT_NEAR(ratio(gap8.core.instruction, gap9.core.instruction), per_cycle, 0.1);
  EXPECT_NEAR(ratio(gap8.l1.access, gap9.l1.access), per_cycle, 0.1);
  EXPECT_NEAR(ratio(gap8.cluster.cycle, Joules(11.8e-12)), per_cycle, 0.1);
  EXPECT_NEAR(ratio(gap8.soc.cycle, Joules(11.8e-12)), per_cycle, 0.1);
  EXPECT_NEAR(ratio(gap8.l2.access, gap9.l2.access), per_cycle, 0.1);
  // The vendor's table has these for GAP9's cluster (FACTS.md#energy-per-event).
  EXPECT_NEAR(ratio(gap8.cluster.leakage, Watts(1.1e-3)), power, 0.1);
}

TEST(Gap8, ReadsBackFromItsResolvedForm) {
  const ResolvedPlatform platform = resolve_platform("gap8");
  const ResolvedPlatform again = resolve_platform_text("again.yaml", to_yaml(platform));
  EXPECT_EQ(numbers_of(again.config), numbers_of(platform.config));
  EXPECT_EQ(to_yaml(again), to_yaml(platform));
}

}  // namespace
}  // namespace leviosim::platform
