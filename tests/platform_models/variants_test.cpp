// Changed platforms: the same as files and -p would give.
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
        platform.config({{"isa.unmeasured_instructions", -1}});
      },
      {"isa.unmeasured_instructions", "out of range"});
  expect_input_error(
      [&] {
        platform.config({{"cluster.workers", 9}});
      },
      {"cluster.workers is 9", "event unit"});
}

}  // namespace
}  // namespace leviosim::platform
