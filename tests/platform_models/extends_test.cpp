// Platforms that extend others: what they take, what they may change, and what is refused.
#include <fstream>

#include "tests/platform_models/platform_test.h"
#include "tests/traces/test_folder.h"

namespace leviosim::platform {
namespace {

constexpr const char* kHead = "name: other\ndescription: \"a test\"\nextends: gap9\n";

ResolvedPlatform extended(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return resolve_platform_text("other.yaml", kHead + text, overrides);
}

TEST(Extends, TakesEveryNumber) {
  const ResolvedPlatform other = extended("");
  EXPECT_EQ(numbers_of(other.config), numbers_of(load_platform("gap9")));
  EXPECT_EQ(other.name, "other");
  EXPECT_EQ(other.parameters.size(), resolve_platform("gap9").parameters.size());
}

TEST(Extends, ReplacesRowsAsAWholeAndCitesTheSourcesOfTheOther) {
  const ResolvedPlatform other =
      extended("cluster:\n  clock: { value: 240, unit: MHz, source: \"MLP\", confidence: high }\n");
  EXPECT_EQ(other.config.cluster.clock.count(), 240'000'000);
  EXPECT_EQ(other.config.controller.clock.count(), 370'000'000);
  for (const Parameter& p : other.parameters)
    if (p.path == "cluster.clock") {
      EXPECT_TRUE(p.note.empty()) << p.note;
    }
}

TEST(Extends, AddsSources) {
  const std::string row =
      "cluster:\n  clock: { value: 240, unit: MHz, source: \"mine\", confidence: high }\n";
  expect_parts(fault_of([&] { extended(row); }), {"other.yaml:5", "'mine' is not listed"});
  EXPECT_NO_THROW(extended("sources:\n  mine: \"my own\"\n" + row));
  expect_parts(fault_of([&] { extended("sources:\n  MLP: \"something else\"\n"); }),
               {"other.yaml:3", "'MLP' stands for something else in gap9.yaml"});
}

TEST(Extends, BareValuesNeedNoMoreThanTheOther) {
  const ResolvedPlatform mine = resolve_platform_text(
      "chips/mine.yaml", "extends: gap9\ncluster: { workers: 4, clock: 240MHz }\n");
  EXPECT_EQ(mine.name, "mine");
  EXPECT_EQ(mine.config.cluster.workers, 4);
  EXPECT_EQ(mine.config.cluster.clock.count(), 240'000'000);
  for (const Parameter& p : mine.parameters)
    if (p.path == "cluster.workers") {
      EXPECT_EQ(p.source, "what if");
      EXPECT_EQ(p.confidence, "assumed");
      EXPECT_FALSE(p.range);
    }
  const ResolvedPlatform again = resolve_platform_text("again.yaml", to_yaml(mine));
  EXPECT_EQ(numbers_of(again.config), numbers_of(mine.config));
  expect_parts(fault_of([&] { extended("cluster: { workers: 0 }\n"); }),
               {"other.yaml:4: cluster.workers"});
  expect_parts(fault_of([&] { extended("isa: { ops: { f32_add: 2 } }\n"); }),
               {"other.yaml:4: isa.ops.f32_add", "single value"});
  expect_parts(fault_of([&] {
                 resolve_platform_text("alone.yaml",
                                       replaced(gap9_text(), "  workers: {", "  workers: 8 # {"));
               }),
               {"cluster.workers", "expected a map"});
}

TEST(Platforms, VariantsAreNamedInLine) {
  const sim::ChipConfig two = load_platform("gap9:cluster.workers=2,cluster.clock=240MHz");
  EXPECT_EQ(two.cluster.workers, 2);
  EXPECT_EQ(two.cluster.clock.count(), 240'000'000);
  EXPECT_EQ(load_platform("gap9:cluster.workers=2", {"cluster.fpu.units=1"}).cluster.workers, 2);
  expect_parts(fault_of([] { load_platform("gap7:cluster.workers=2"); }), {"'gap7'", "gap8"});
  expect_parts(fault_of([] { load_platform("gap9:cluster.wokers=2"); }),
               {"cluster.wokers", "cluster.workers"});
  expect_parts(fault_of([] { load_platform("gap9:cluster.workers"); }), {"unknown platform"});
  expect_parts(fault_of([] { load_platform("gap9:cluster.workers=2,"); }), {"expected path=value"});
}

TEST(Extends, OverridesApplyToTheWhole) {
  EXPECT_EQ(extended("", {"cluster.workers=3"}).config.cluster.workers, 3);
  const sim::ChipConfig plain = extended("", {"isa.base=rv32imfc"}).config;
  EXPECT_EQ(numbers_of(plain), numbers_of(load_platform("gap9", {"isa.base=rv32imfc"})));
}

TEST(Extends, RulesHoldForTheWhole) {
  expect_parts(
      fault_of([&] {
        extended(
            "supply:\n  voltage: { value: 0.65, unit: V, source: \"MLP\", confidence: high }\n");
      }),
      {"cluster.clock is 370 MHz (gap9.yaml:", "supply.voltage is 0.65 V (other.yaml:5)",
       "at most 240 MHz"});
}

TEST(Extends, NamesNoInstructionSet) {
  expect_parts(fault_of([&] { extended("isa: { base: rv32imfc }\n"); }),
               {"other.yaml:4: isa.base", "has named its instruction set"});
}

TEST(Extends, UnknownNamesAndCirclesAreRefused) {
  expect_parts(
      fault_of([] { resolve_platform_text("x.yaml", "name: x\ndescription: y\nextends: gap7\n"); }),
      {"x.yaml:3: extends", "unknown platform 'gap7'", "gap8"});
  const traces::testing::TempFolder folder;
  for (const auto& [name, parent] : {std::pair("a.yaml", "./b.yaml"), {"b.yaml", "./a.yaml"}})
    std::ofstream(folder.path() / name) << "name: x\ndescription: y\nextends: " << parent << "\n";
  expect_parts(fault_of([&] { resolve_platform((folder.path() / "a.yaml").string()); }),
               {"builds on itself"});
  expect_parts(fault_of([&] {
                 resolve_platform_text((folder.path() / "c.yaml").string(),
                                       "name: x\ndescription: y\nextends: ./d.yaml\n");
               }),
               {"there is no file", "d.yaml"});
}

TEST(Extends, IsWrittenAsOneFile) {
  const ResolvedPlatform other = resolve_platform("gap9-240mhz");
  const ResolvedPlatform again = resolve_platform_text("again.yaml", to_yaml(other));
  EXPECT_EQ(numbers_of(again.config), numbers_of(other.config));
}

// FACTS.md#operating-points: the two systems that were measured.
TEST(OperatingPointsOfGap9, AreThoseOfTheMeasuredSystems) {
  EXPECT_EQ(numbers_of(load_platform("gap9-370mhz")), numbers_of(load_platform("gap9")));
  EXPECT_EQ(numbers_of(load_platform("gap9-240mhz")),
            numbers_of(load_platform("gap9", {"cluster.clock=240MHz", "controller.clock=240MHz",
                                              "supply.voltage=0.65V"})));
}

}  // namespace
}  // namespace leviosim::platform
