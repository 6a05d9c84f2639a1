// Sections `supply` and `energy`: clocks that a voltage does not allow, bands, completeness.
#include "sim/energy/uncertainty_sources.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

std::string supply_fault(const std::vector<std::string>& overrides) {
  return fault_of([&] { load_platform("gap9", overrides); });
}

TEST(Supply, BothMeasuredPointsCanBeRun) {
  const sim::ChipConfig chip = load_platform(
      "gap9", {"cluster.clock=240MHz", "controller.clock=240MHz", "supply.voltage=0.65V"});
  EXPECT_EQ(chip.supply.voltage, Volts(0.65));
  EXPECT_EQ(load_platform("gap9").supply.voltage, Volts(0.8));
  EXPECT_NO_THROW(load_platform("gap9", {"cluster.clock=100MHz", "controller.clock=50MHz"}));
}

TEST(Supply, AClockThatTheVoltageDoesNotAllowIsRefusedWithTheVoltageThatDoes) {
  expect_parts(supply_fault({"supply.voltage=650mV"}),
               {"cluster.clock is 370 MHz (gap9.yaml:", "supply.voltage is 650 mV (-p ",
                "at most 240 MHz, as with cluster.clock=240MHz and controller.clock=240MHz; ",
                "370 MHz needs supply.voltage=0.8 V"});
  expect_parts(supply_fault({"supply.voltage=0.65V", "cluster.clock=240MHz"}),
               {"controller.clock is 370 MHz", "as with controller.clock=240MHz; "});
  expect_parts(supply_fault({"supply.voltage=0.7", "cluster.clock=300MHz"}),
               {"cluster.clock is 300 MHz (-p", "supply.voltage=0.75 V"});
}

TEST(Supply, AClockBeyondAllVoltagesIsRefused) {
  expect_parts(supply_fault({"cluster.clock=400MHz"}),
               {"cluster.clock is 400 MHz", "no voltage allows more than 370 MHz"});
  EXPECT_NO_THROW(load_platform("gap9", {"cluster.clock=400MHz", "supply.highest.clock=450MHz"}));
}

TEST(Supply, VoltagesOffTheStepsAndBeyondTheEndsAreRefused) {
  for (const char* volts : {"0.72V", "0.6V", "0.85V", "660mV"})
    expect_parts(supply_fault({std::string("supply.voltage=") + volts}),
                 {"supply.voltage is", "0.65 V to 0.8 V in steps of 0.05 V"});
}

TEST(Supply, ThePointsMustBeInOrder) {
  expect_parts(supply_fault({"supply.lowest.voltage=0.9V"}),
               {"supply.lowest.voltage is 0.9 V", "supply.highest.voltage is 0.8 V"});
  expect_parts(supply_fault({"supply.lowest.clock=380MHz"}),
               {"supply.lowest.clock is 380 MHz", "supply.highest.clock is 370 MHz"});
}

std::string without(std::string text, std::string_view from, std::string_view to) {
  const std::size_t begin = text.find(from);
  const std::size_t end = to.empty() ? text.size() : text.find(to);
  EXPECT_NE(begin, std::string::npos);
  return text.erase(begin, end - begin);
}

TEST(Supply, AChipMayHaveNoEnergyFigures) {
  const std::string text = without(gap9_text(), "\nsupply:", "");
  const sim::ChipConfig chip =
      resolve_platform_text("plain.yaml", text, {"cluster.clock=900MHz"}).config;
  EXPECT_EQ(chip.supply.voltage, Volts(0));
}

TEST(Supply, ButNotPartOfThem) {
  const std::string text = without(gap9_text(), "\nenergy:", "\narea:");
  expect_parts(fault_of([&] { resolve_platform_text("part.yaml", text); }),
               {"supply.", "part.yaml:", "energy.voltage is missing", "in full, or neither"});
}

// The bands that the model works with are the ranges of the file.
TEST(EnergyFigures, RangesBecomeBandsInBaseUnits) {
  const sim::EnergyRange energy = load_platform("gap9").energy;
  EXPECT_DOUBLE_EQ(energy.value.core.instruction.count(), 4.98e-12);
  EXPECT_DOUBLE_EQ(energy.low.core.instruction.count(), 2.49e-12);
  EXPECT_DOUBLE_EQ(energy.high.core.instruction.count(), 7.5e-12);
  EXPECT_DOUBLE_EQ(energy.high.soc.static_power.count(), 2.1e-3);
  EXPECT_EQ(energy.low.voltage, energy.value.voltage);
}

TEST(EnergyFigures, AnOverriddenNumberHasNoBand) {
  const sim::EnergyRange energy = load_platform("gap9", {"energy.core.instruction=3pJ"}).energy;
  for (const sim::EnergyConfig& e : {energy.value, energy.low, energy.high})
    EXPECT_DOUBLE_EQ(e.core.instruction.count(), 3e-12);
}

TEST(EnergyFigures, BandsSurviveTheResolvedFile) {
  const ResolvedPlatform before = resolve_platform("gap9", {"energy.l1.access=2pJ"});
  const sim::EnergyRange a = before.config.energy;
  const sim::EnergyRange b = resolve_platform_text("again.yaml", to_yaml(before)).config.energy;
  EXPECT_EQ(a.low.by_size.gate_cycle, b.low.by_size.gate_cycle);
  EXPECT_EQ(a.high.soc.static_power, b.high.soc.static_power);
  EXPECT_EQ(b.low.l1.access, b.high.l1.access);
}

bool is_area(const Field& field) {
  return field.path.starts_with("area.") || field.path.ends_with(".area");
}

/// Numbers of the section `energy`, in the order of the schema.
std::vector<double> energy_numbers(const sim::EnergyConfig& energy) {
  sim::ChipConfig chip;
  chip.energy.value = energy;
  std::vector<double> numbers;
  const Schema schema;
  for (const Field& field : schema.fields())
    if (field.set_band && field.path != "energy.voltage" && !is_area(field))
      numbers.push_back(field.get(chip));
  return numbers;
}

// What belongs to no source would have a range in the file and no part in the bands.
TEST(EnergyFigures, EveryNumberBelongsToExactlyOneSource) {
  // One has leakages by size, the other fixed ones.
  sim::EnergyConfig from = load_platform("gap8").energy.value;
  from.core.f32_operation = load_platform("gap9").energy.value.core.f32_operation;
  from.by_size = load_platform("gap9").energy.value.by_size;
  from.cluster_accelerators.fill(Joules(1e-12));  // GAP9 has none
  from.controller_accelerators.fill(Joules(2e-12));
  const std::vector<double> expected = energy_numbers(from);
  std::vector<int> copies(expected.size(), 0);
  for (const sim::UncertaintySource& source : sim::kUncertaintySources) {
    sim::EnergyConfig to{};
    source.copy(from, to);
    const std::vector<double> copied = energy_numbers(to);
    for (std::size_t i = 0; i < expected.size(); ++i) copies[i] += copied[i] == expected[i] ? 1 : 0;
  }
  EXPECT_EQ(copies, std::vector<int>(expected.size(), 1));
}

}  // namespace
}  // namespace leviosim::platform
