// STM32F405: a chip with one core in terms of a cluster, and how its uncertain numbers are marked.
#include "platform_models/loader/parameter_units.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

// FACTS.md#other-chips, FACTS.md#cortex-m4f.
TEST(CortexM4f, OneCoreDoesAllTheWork) {
  const sim::ChipConfig chip = load_platform("cortex-m4f");
  EXPECT_EQ(chip.cluster.clock.count(), 168'000'000);
  EXPECT_EQ(chip.controller.clock.count(), 168'000'000);
  EXPECT_EQ(chip.cluster.max_workers, 1);
  EXPECT_TRUE(chip.controller.shares_core);
  EXPECT_EQ(chip.cluster.icache.shared.count(), 64 * 16);
  for (const work::OpInfo& info : work::kOps)
    EXPECT_EQ(chip.cluster.core[info.op].unit, sim::Unit::Core) << info.name;
}

// FACTS.md#cortex-m4f: 130 to 290 mW at 168 MHz.
TEST(CortexM4f, EnergyIsThatOfItsSupplyCurrent) {
  const sim::ChipConfig chip = load_platform("cortex-m4f");
  const double clock = static_cast<double>(chip.controller.clock.count());
  EXPECT_NEAR(chip.energy.low.soc.cycle.count() * clock, 0.130, 0.005);
  EXPECT_NEAR(chip.energy.high.soc.cycle.count() * clock, 0.290, 0.005);
}

TEST(CortexM4f, EveryUncertainNumberHasARangeThatCanBeRun) {
  for (const Parameter& p : resolve_platform("cortex-m4f").parameters) {
    if (p.unit.empty() || p.confidence == "high") continue;
    ASSERT_TRUE(p.range) << p.path << " has confidence " << p.confidence << " and no range";
    for (const double end : {p.range->low, p.range->high})
      EXPECT_NO_THROW(load_platform("cortex-m4f", {p.path + "=" + number_text(end) + p.unit}))
          << p.path;
  }
}

}  // namespace
}  // namespace leviosim::platform
