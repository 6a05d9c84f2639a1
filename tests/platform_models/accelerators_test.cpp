// Accelerators in platform files: all of one or nothing, and what contradicts the rest is refused.
#include "platform_models/loader/parameter_units.h"
#include "tests/platform_models/platform_test.h"
#include "tests/support/paths.h"

namespace leviosim::platform {
namespace {

using work::OffloadKind;

sim::AcceleratorConfig of(const sim::ChipConfig& chip, OffloadKind kind) {
  return chip.cluster.accelerators[work::index(kind)];
}

TEST(Accelerators, AreReadAndWritten) {
  const ResolvedPlatform platform = resolve_platform("gap9-hamming");
  const sim::AcceleratorConfig hamming = of(platform.config, OffloadKind::Hamming);
  EXPECT_EQ(hamming.units, 1);
  EXPECT_EQ(hamming.start_up, 40);
  EXPECT_EQ(hamming.items_per_cycle, 2);
  EXPECT_EQ(of(platform.config, OffloadKind::Eigen3).units, 0);
  EXPECT_EQ(platform.config.energy.high.cluster_accelerators[work::index(OffloadKind::Hamming)],
            Joules(8e-12));
  EXPECT_EQ(numbers_of(resolve_platform_text("again.yaml", to_yaml(platform)).config),
            numbers_of(platform.config));
}

TEST(Accelerators, AreNotOnChipsThatSayNothingOfThem) {
  for (const char* name : {"gap9", "gap8", "cortex-m4f"})
    for (const work::OffloadKindInfo& info : work::kOffloadKinds) {
      EXPECT_EQ(of(load_platform(name), info.kernel).units, 0);
      EXPECT_EQ(load_platform(name).controller.accelerators[work::index(info.kernel)].units, 0);
    }
}

TEST(Accelerators, CanBeOverridden) {
  EXPECT_EQ(of(load_platform("gap9-hamming", {"cluster.accelerators.hamming.units=3"}),
               OffloadKind::Hamming)
                .units,
            3);
}

TEST(Accelerators, AreGivenAsAWhole) {
  expect_parts(fault_of([] { load_platform("gap9", {"cluster.accelerators.hamming.units=1"}); }),
               {"cluster.accelerators.hamming.units is 1 units (-p",
                "cluster.accelerators.hamming.start_up is missing", "all of an accelerator"});
  expect_parts(
      fault_of([] { load_platform("gap9", {"controller.accelerators.solve.energy=1pJ"}); }),
      {"controller.accelerators.solve.units is missing"});
}

TEST(Accelerators, ContradictionsAreRefused) {
  const auto fault = [](const std::string& override) {
    return fault_of([&] { load_platform("gap9-hamming", {override}); });
  };
  expect_parts(fault("cluster.accelerators.hamming.l1_words=17"),
               {"l1_words is 17", "cluster.l1.banks is 16", "no more words per cycle than banks"});
  expect_parts(fault("cluster.accelerators.hamming.units=0"), {"hamming.units", "1"});
  expect_parts(fault("cluster.accelerators.hamming.items_per_cycle=0"), {"items_per_cycle"});
  expect_parts(fault("cluster.accelerators.haming.units=1"),
               {"unknown key", "cluster.accelerators.hamming.units"});
  // The controller has no L1.
  expect_parts(fault("controller.accelerators.solve.l1_words=1"), {"unknown key"});
}

TEST(Accelerators, OfTheControllerNeedNoL1) {
  const sim::ChipConfig chip = load_platform(
      "gap9", {"controller.accelerators.solve.units=1", "controller.accelerators.solve.start_up=30",
               "controller.accelerators.solve.latency=10",
               "controller.accelerators.solve.items_per_cycle=4",
               "controller.accelerators.solve.energy=3pJ"});
  EXPECT_EQ(chip.controller.accelerators[work::index(OffloadKind::Solve)].items_per_cycle, 4);
  EXPECT_EQ(of(chip, OffloadKind::Solve).units, 0);
}

/// A chip without energy figures may have accelerators without them.
TEST(Accelerators, NeedNoEnergyWhereThereIsNone) {
  EXPECT_NO_THROW(load_platform(
      (leviosim::tests::source_folder() / "tests/examples/quad.yaml").string(),
      {"cluster.accelerators.hamming.units=1", "cluster.accelerators.hamming.start_up=30",
       "cluster.accelerators.hamming.latency=10", "cluster.accelerators.hamming.items_per_cycle=4",
       "cluster.accelerators.hamming.l1_words=4"}));
}

class AcceleratorExample : public ::testing::TestWithParam<const char*> {};

/// Nobody has built them.
TEST_P(AcceleratorExample, EveryFigureIsAssumedAndHasARangeThatCanBeRun) {
  int figures = 0;
  for (const Parameter& p : resolve_platform(GetParam()).parameters) {
    if (p.path.find(".accelerators.") == std::string::npos) continue;
    ++figures;
    EXPECT_EQ(p.confidence, "assumed") << p.path;
    ASSERT_TRUE(p.range) << p.path;
    EXPECT_LT(p.range->low, p.range->high) << p.path;
    for (const double end : {p.range->low, p.range->high})
      EXPECT_NO_THROW(load_platform(GetParam(), {p.path + "=" + number_text(end) + p.unit}));
  }
  EXPECT_GE(figures, 6);
}

INSTANTIATE_TEST_SUITE_P(All, AcceleratorExample,
                         ::testing::Values("gap9-eigen", "gap9-hamming", "gap9-corners"));

}  // namespace
}  // namespace leviosim::platform
