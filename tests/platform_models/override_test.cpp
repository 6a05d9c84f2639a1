// Overrides (-p): they change what they name and nothing else, under the checks of files.

#include "platform_models/loader/energy_fields.h"
#include "platform_models/loader/parameter_units.h"
#include "platform_models/loader/schema.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

sim::ChipConfig with(const std::vector<std::string>& overrides) {
  return load_platform("gap9", overrides);
}

std::string fault(const std::string& override) {
  return fault_of([&] { with({override}); });
}

TEST(Override, UnitsAreConverted) {
  EXPECT_EQ(with({"cluster.clock=240MHz"}).cluster.clock.count(), 240'000'000);
  EXPECT_EQ(with({"cluster.clock=240 MHz"}).cluster.clock.count(), 240'000'000);
  EXPECT_EQ(with({"cluster.clock=0.24GHz"}).cluster.clock.count(), 240'000'000);
  EXPECT_EQ(with({"cluster.l1.size=64KiB"}).cluster.l1.size.count(), 65536);
  EXPECT_EQ(with({"cluster.l1.size=64kB"}).cluster.l1.size.count(), 64000);
  EXPECT_EQ(with({" cluster.dma.bytes_per_cycle = 4 B/cycle "}).cluster.dma.bytes_per_cycle, 4);
}

TEST(Override, WithoutUnitTheUnitOfTheFileHolds) {
  EXPECT_EQ(with({"cluster.clock=240"}).cluster.clock.count(), 240'000'000);
  EXPECT_EQ(with({"cluster.l1.size=64"}).cluster.l1.size.count(), 65536);
  EXPECT_EQ(with({"l2.size=2"}).l2.size.count(), 2097152);
}

TEST(Override, ChoicesAreNames) {
  EXPECT_EQ(with({"cluster.fpu.mapping=dynamic"}).cluster.fpu.mapping, sim::FpuMapping::Dynamic);
  EXPECT_EQ(with({"isa.ops.f32_compare.on=core"}).cluster.core[work::Op::F32Compare].unit,
            sim::Unit::Core);
}

TEST(Override, IsaSpeaksOfBothKindsOfCore) {
  const sim::ChipConfig chip = with({"isa.ops.f32_add.issue=2"});
  EXPECT_EQ(chip.cluster.core[work::Op::F32Add].issue, 2);
  EXPECT_EQ(chip.controller.core[work::Op::F32Add].issue, 2);
}

TEST(Override, DifferencesOfACoreWinOverIsa) {
  const sim::ChipConfig chip = with({"cluster.core.ops.f32_add.issue=3", "isa.ops.f32_add.issue=2",
                                     "controller.core.unmeasured_instructions=1.5"});
  EXPECT_EQ(chip.cluster.core[work::Op::F32Add].issue, 3);
  EXPECT_EQ(chip.controller.core[work::Op::F32Add].issue, 2);
  EXPECT_EQ(chip.cluster.core.unmeasured_instructions,
            with({}).cluster.core.unmeasured_instructions);
  EXPECT_EQ(chip.controller.core.unmeasured_instructions, 1.5);
  EXPECT_EQ(chip.controller.core[work::Op::F32Div].stall, 14);
}

/// What has to be changed too, so that another value is possible: lower voltages need lower clocks.
std::vector<std::string> beside(const Field& field) {
  if (field.path == "controller.runs_on") return {"cluster.workers=1", "cluster.max_workers=1"};
  if (energy_group_of(field) == EnergyGroup::None) return {};
  return {"cluster.clock=200MHz", "controller.clock=200MHz"};
}

/// The chip with a value of this field that differs from the present one and is allowed.
sim::ChipConfig changed(const Field& field, double present) {
  if (field.is_choice()) {
    std::vector<std::string> overrides = beside(field);
    overrides.push_back(field.path + "=" + field.choices[present == 0 ? 1 : 0]);
    return with(overrides);
  }
  constexpr double kSupplyStep = 0.05;
  for (const double candidate : {present + 1, present - 1, present * 2, present / 2,
                                 present - kSupplyStep, present + kSupplyStep}) {
    const std::string unit(field.dimension->units[0].name);
    std::vector<std::string> overrides = beside(field);
    overrides.push_back(field.path + "=" + number_text(candidate) + unit);
    try {
      return with(overrides);
    } catch (const InputError&) {
      continue;
    }
  }
  ADD_FAILURE() << "no other value of " << field.path << " is allowed";
  return load_platform("gap9");
}

bool starts_with(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

/// Whether changing `field` may change what `other` reads: `isa` speaks of all cores, and a
/// section about some of the cores has the same keys.
bool related(const Field& field, const Field& other) {
  if (field.path == other.path) return true;
  const auto is_core = [](const Field& f) {
    return starts_with(f.path, "isa.") || starts_with(f.path, "cluster.core.") ||
           starts_with(f.path, "controller.core.");
  };
  const auto key = [](const Field& f) {
    const std::size_t core = f.path.find("core.");
    return f.path.substr(core == std::string::npos ? 4 : core + 5);
  };
  return is_core(field) && is_core(other) && key(field) == key(other);
}

TEST(Override, EveryParameterCanBeChangedAndChangesOnlyItself) {
  const Schema schema;
  for (const Field& field : schema.fields()) {
    // Given as a whole or not at all (accelerators_test.cpp); GAP9 has none.
    if (field.path.find(".accelerators.") != std::string::npos) continue;
    // GAP9 has leakages by size in their place.
    if (energy_group_of(field) == EnergyGroup::Fixed) continue;
    const sim::ChipConfig before = with(beside(field));
    const sim::ChipConfig after = changed(field, field.get(before));
    EXPECT_NE(field.get(after), field.get(before)) << field.path;
    for (const Field& other : schema.fields())
      EXPECT_TRUE(related(field, other) || other.get(after) == other.get(before))
          << field.path << " changes " << other.path;
  }
}

TEST(Override, IsMarkedAsSuch) {
  const ResolvedPlatform platform = resolve_platform("gap9", {"cluster.dma.programming=12"});
  int overridden = 0;
  for (const Parameter& p : platform.parameters) {
    overridden += p.overridden;
    if (p.path != "cluster.dma.programming") continue;
    EXPECT_TRUE(p.overridden);
    EXPECT_EQ(p.value, "12");
    EXPECT_EQ(p.unit, "cycles");
    EXPECT_EQ(p.source, "override (-p)");
    EXPECT_EQ(p.confidence, "assumed");
    EXPECT_FALSE(p.range);
  }
  EXPECT_EQ(overridden, 1);
}

TEST(Override, UnknownKeysAreRefusedWithTheNearest) {
  EXPECT_EQ(fault("cluster.fpus=2"),
            "-p cluster.fpus=2: unknown key; did you mean 'cluster.fpu.units'?");
  expect_parts(fault("cluster.wrokers=2"), {"did you mean 'cluster.workers'"});
  expect_parts(fault("isa.ops.f32_ad.issue=2"), {"did you mean 'isa.ops.f32_add.issue'"});
  expect_parts(fault("workers=2"), {"did you mean 'cluster.workers'"});
  EXPECT_EQ(fault("zzz=2"), "-p zzz=2: unknown key");
  EXPECT_EQ(fault("=2"), "-p =2: unknown key");
}

TEST(Override, SectionsAndRowsAreNoValues) {
  expect_parts(fault("cluster.l1=2"), {"-p cluster.l1=2", "'cluster.l1.size'"});
  expect_parts(fault("isa.ops.f32_add=2"), {"'isa.ops.f32_add.issue'"});
}

TEST(Override, BadValuesAreRefused) {
  expect_parts(fault("cluster.workers"), {"-p cluster.workers: expected path=value"});
  expect_parts(fault("cluster.workers="), {"expected a value"});
  expect_parts(fault("cluster.workers=many"), {"'many' is not a number"});
  expect_parts(fault("cluster.workers=nan"), {"not a finite number"});
  expect_parts(fault("cluster.clock=-infMHz"), {"not a finite number"});
  expect_parts(fault("cluster.workers=0"), {"0 cores is out of range", "1 to 1024"});
  expect_parts(fault("cluster.workers=2.5"), {"2.5 cores is no whole number"});
  expect_parts(fault("cluster.clock=5 cores"), {"'cores' is no unit of a frequency", "MHz"});
  expect_parts(fault("cluster.clock=0x10"), {"'x10' is no unit"});
  expect_parts(fault("cluster.fpu.mapping=dynamc"), {"fixed, dynamic", "'dynamic'"});
  expect_parts(fault("cluster.fpu.mapping=1"), {"'1' is not known", "fixed, dynamic"});
}

TEST(Override, NoParameterTwice) {
  expect_parts(fault_of([] {
                 with({"cluster.workers=4", "cluster.workers=2"});
               }),
               {"-p cluster.workers=2", "already given by -p cluster.workers=4"});
}

TEST(Override, RulesBetweenParametersNameBothSides) {
  expect_parts(fault("cluster.workers=9"), {"cluster.workers is 9 cores (-p cluster.workers=9)",
                                            "cluster.max_workers is 8 cores (gap9.yaml:"});
  EXPECT_EQ(with({"cluster.workers=16", "cluster.max_workers=16"}).cluster.workers, 16);
  expect_parts(fault("cluster.l1.banks=12"), {"cluster.l1.banks is 12 banks", "a power of two"});
  expect_parts(fault("cluster.fpu.units=0"),
               {"cluster.fpu.units is 0 units", "isa.ops.f32_add.on is fpu (isa/rv32imfc.yaml:"});
  expect_parts(fault("isa.ops.f32_div.stall=12"),
               {"isa.ops.f32_div.busy is 14 cycles (isa/rv32imfc.yaml:",
                "isa.ops.f32_div.stall is 12 cycles (-p isa.ops.f32_div.stall=12)"});
  expect_parts(fault("cluster.fpu.int64_units=0"), {"isa.ops.int64_add.on is int64"});
  expect_parts(fault("cluster.fpu.dividers=0"), {"isa.ops.f32_div.on is divider"});
}

TEST(Override, CachesHaveALineForEachWay) {
  expect_parts(fault("cluster.icache.line=3"), {"cluster.icache.line is 3 B", "a power of two"});
  expect_parts(fault("cluster.icache.line=1024"),
               {"cluster.icache.size is 512 B", "at least 4096 B, a line for each of 4 ways"});
  expect_parts(fault("cluster.icache.size=32"), {"cluster.icache.size is 32 B", "at least 64 B"});
  expect_parts(fault("controller.icache.size=8B"), {"controller.icache.size is 8 B", "at least"});
  EXPECT_EQ(with({"cluster.icache.size=64"}).cluster.icache.worker, Bytes(64));
  EXPECT_EQ(with({"cluster.icache.size=0"}).cluster.icache.worker, Bytes(0));
}

/// Areas would be taken for unknown, and with them leakage and the energy of clocks.
TEST(Override, GatesHaveAnArea) {
  expect_parts(fault("area.gate=0"), {"area.gate is 0 um2", "more than 0"});
}

// The cluster may do without a unit that only the controller's operations use.
TEST(Override, UnitsAreRequiredOfTheCoresThatShareThem) {
  const std::vector<std::string> without = {
      "cluster.fpu.dividers=0", "cluster.core.ops.f32_div.on=core",
      "cluster.core.ops.f32_sqrt.on=core", "cluster.core.ops.f16_div.on=core"};
  EXPECT_EQ(with(without).cluster.fpu.dividers, 0);
  expect_parts(
      fault_of([] {
        with({"cluster.fpu.dividers=0", "isa.ops.f32_div.on=core", "isa.ops.f32_sqrt.on=core",
              "isa.ops.f16_div.on=core", "cluster.core.ops.f32_div.on=divider"});
      }),
      {"cluster.core.ops.f32_div.on is divider"});
}

}  // namespace
}  // namespace leviosim::platform
