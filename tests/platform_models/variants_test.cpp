// Changed platforms: the same as files and -p would give, and calibrations that say what they are.
#include "platform_models/loader/variants.h"

#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"
#include "tests/traces/test_folder.h"

namespace leviosim::platform {
namespace {

using traces::testing::expect_input_error;

Variants gap9(const std::vector<std::string>& overrides = {}) {
  return Variants(resolve_platform("gap9", overrides));
}

const Parameter& parameter(const ResolvedPlatform& platform, const std::string& path) {
  for (const Parameter& p : platform.parameters)
    if (p.path == path) return p;
  ADD_FAILURE() << path;
  return platform.parameters.front();
}

/// All numbers of a chip, by the schema.
std::vector<double> numbers(const sim::ChipConfig& chip) {
  const Schema schema;
  std::vector<double> all;
  for (const Field& field : schema.fields()) all.push_back(field.get(chip));
  return all;
}

TEST(Variants, WithoutChangesIsThePlatform) {
  for (const std::vector<std::string>& overrides :
       {std::vector<std::string>{}, {"cluster.clock=240MHz", "isa.ops.f32_add.issue=3"}})
    EXPECT_EQ(numbers(gap9(overrides).config({})), numbers(load_platform("gap9", overrides)));
}

TEST(Variants, AChangeIsWhatAnOverrideWouldBe) {
  EXPECT_EQ(numbers(gap9().config({{"cluster.clock", 240}, {"isa.ops.call.issue", 7.5}})),
            numbers(load_platform("gap9", {"cluster.clock=240MHz", "isa.ops.call.issue=7.5"})));
}

TEST(Variants, WhatDiffersFromTheCommonIsaStaysDifferent) {
  const sim::ChipConfig chip = gap9().config({{"isa.ops.f32_div.stall", 20}});
  EXPECT_EQ(chip.cluster.core[work::Op::F32Div].stall, 20);
  EXPECT_EQ(chip.controller.core[work::Op::F32Div].stall, 14);
}

TEST(Variants, RefusesWhatFilesRefuse) {
  const Variants platform = gap9();
  expect_input_error(
      [&] {
        platform.config({{"cluster.workerz", 4}});
      },
      {"cluster.workerz", "did you mean 'cluster.workers'"});
  expect_input_error(
      [&] {
        platform.config({{"cluster.core.ops.call.issue", 4}});
      },
      {"cluster.core.ops.call.issue", "does not give"});
  expect_input_error(
      [&] {
        platform.config({{"isa.instruction_overhead", -1}});
      },
      {"isa.instruction_overhead", "out of range"});
  expect_input_error(
      [&] {
        platform.config({{"cluster.workers", 9}});
      },
      {"cluster.workers is 9", "event unit"});
}

TEST(Calibrated, SaysSoBesideTheNumberAndKeepsItsRange) {
  const ResolvedPlatform result =
      gap9().calibrated({{"isa.instruction_overhead", 1.25}}, "how", "what it means");
  EXPECT_EQ(result.config.cluster.core.instruction_overhead, 1.25);
  const std::string text = to_yaml(result);
  const ResolvedPlatform again = resolve_platform_text("calibrated.yaml", text);
  EXPECT_EQ(numbers(again.config), numbers(result.config));
  const Parameter& p = parameter(again, "isa.instruction_overhead");
  EXPECT_EQ(p.value, "1.25");
  EXPECT_EQ(p.confidence, "calibrated");
  EXPECT_EQ(p.source, "calibrated (how)");
  ASSERT_TRUE(p.range.has_value());
  EXPECT_EQ(p.range->high, 1.4);
  EXPECT_NE(text.find("\"calibrated\": \"what it means\""), std::string::npos);
  EXPECT_EQ(to_yaml(again), text);
}

TEST(Calibrated, ARowNamesTheColumnThatWasFitted) {
  const std::string text =
      to_yaml(gap9().calibrated({{"isa.ops.call.issue", 9}}, "how", "what it means"));
  EXPECT_NE(text.find("source: \"calibrated (how): issue; the rest: assumption (jumps"),
            std::string::npos);
  EXPECT_EQ(to_yaml(resolve_platform_text("calibrated.yaml", text)), text);
}

TEST(Calibrated, StandsBesideAnOverrideInOneRow) {
  const std::string text = to_yaml(
      gap9({"isa.ops.call.stall=3"}).calibrated({{"isa.ops.call.issue", 9}}, "how", "meaning"));
  EXPECT_NE(text.find("calibrated (how): issue; override (-p): stall; the rest: assumption"),
            std::string::npos);
}

TEST(Calibrated, NothingElseChanges) {
  const ResolvedPlatform before = resolve_platform("gap9");
  const ResolvedPlatform after = gap9().calibrated({{"isa.ops.call.issue", 9}}, "how", "meaning");
  ASSERT_EQ(before.parameters.size(), after.parameters.size());
  for (std::size_t i = 0; i < before.parameters.size(); ++i) {
    if (before.parameters[i].path == "isa.ops.call.issue") continue;
    EXPECT_EQ(before.parameters[i].value, after.parameters[i].value);
    EXPECT_EQ(before.parameters[i].source, after.parameters[i].source);
    EXPECT_EQ(before.parameters[i].confidence, after.parameters[i].confidence);
  }
}

}  // namespace
}  // namespace leviosim::platform
