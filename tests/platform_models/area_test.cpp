// Areas of GAP9 against published clusters and chips, what its parts add, and what sections a
// platform may have.
#include "sim/energy/area.h"

#include <fmt/format.h>

#include "sim/energy/model.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

constexpr double kMm2 = 1e6;  // square micrometres

double cluster_mm2(const sim::ChipConfig& chip) {
  return sim::cluster_area(chip).area.count() / kMm2;
}
/// What the overrides add to GAP9's cluster, in thousands of square micrometres.
double added(std::vector<std::string> overrides) {
  return 1e3 * (cluster_mm2(load_platform("gap9", overrides)) - cluster_mm2(load_platform("gap9")));
}

// FACTS.md#area: eight cores, 128 kB, no floating-point unit, 0.50 mm2 placed in 22 nm.
TEST(Area, ThePublishedClusterWithoutFloatingPointUnitsIsWithinTheBand) {
  sim::ChipConfig chip = load_platform("gap9");
  chip.cluster.workers = 7;  // and the master
  chip.cluster.fpu.units = chip.cluster.fpu.dividers = chip.cluster.fpu.int64_units = 0;
  for (sim::AreaConfig* a : {&chip.area.value, &chip.area.low, &chip.area.high})
    a->not_simulated = {};  // the accelerator is published beside it
  const sim::AreaItem cluster = sim::cluster_area(chip);
  RecordProperty("mm2", std::to_string(cluster.area.count() / kMm2));
  EXPECT_LT(cluster.low.count(), 0.50 * kMm2);
  EXPECT_GT(cluster.high.count(), 0.50 * kMm2);
  EXPECT_NEAR(cluster.area.count(), 0.50 * kMm2, 0.15 * kMm2);
}

// A die of 12 mm2 with 4 MB of non-volatile memory (Vega), a package of 3.7 mm x 3.7 mm (GAP9).
TEST(Area, TheLogicAndMemoriesFitOnPublishedDies) {
  constexpr double kNonVolatile = 3.5 * kMm2;
  const sim::AreaItem chip = sim::total_area(load_platform("gap9"));
  EXPECT_LT(chip.high.count() + kNonVolatile, 12 * kMm2);
  EXPECT_GT(chip.low.count(), 2 * kMm2);
  EXPECT_TRUE(chip.known);
}

// FACTS.md#area works these out by hand.
TEST(Area, WhatPartsAddIsTheHandCountOfTheFacts) {
  EXPECT_NEAR(cluster_mm2(load_platform("gap9")), 0.69, 0.02);
  EXPECT_NEAR(sim::total_area(load_platform("gap9")).area.count() / kMm2, 3.7, 0.1);
  EXPECT_NEAR(added({"cluster.fpu.units=8"}), 53, 1);
  EXPECT_NEAR(added({"cluster.fpu.units=2"}), -27, 1);
  EXPECT_NEAR(added({"cluster.workers=16", "cluster.max_workers=16"}), 166, 5);
  EXPECT_NEAR(added({"cluster.l1.banks=32"}), 87, 2);
  EXPECT_NEAR(added({"cluster.l1.size=256KiB"}), 210, 2);
  // From latches to a memory block (of which the constant is more than the bits), with more tags.
  EXPECT_NEAR(added({"cluster.icache.size=1KiB"}),
              8 * (5.0 + 0.2 * 8.192 - 1.1 * 4.096 + 1.1 * 0.768), 0.5);
  EXPECT_NEAR(added({"cluster.icache.size=2KiB"}) - added({"cluster.icache.size=1KiB"}),
              8 * (0.2 * 8.192 + 1.1 * 1.472), 0.5);
  EXPECT_NEAR(added({"cluster.fpu.dividers=4"}), 9.5, 7);  // with their network
}

TEST(Area, ThePartsAddUpAndEachLiesInItsBand) {
  const sim::ChipConfig chip = load_platform("gap9");
  double sum = 0;
  for (const sim::AreaItem& item : sim::areas_of(chip)) {
    EXPECT_LE(item.low, item.area) << item.name;
    EXPECT_GE(item.high, item.area) << item.name;
    sum += item.area.count();
  }
  EXPECT_NEAR(sim::total_area(chip).area.count(), sum, 1e-3);
}

/// Every key that makes hardware more, with a larger value.
const std::vector<std::vector<std::string>> kMore{{"cluster.workers=16", "cluster.max_workers=16"},
                                                  {"cluster.fpu.units=8"},
                                                  {"cluster.fpu.mapping=dynamic"},
                                                  {"cluster.fpu.dividers=8"},
                                                  {"cluster.icache.size=1KiB"},
                                                  {"cluster.icache.size=4KiB"},
                                                  {"cluster.icache.master_size=8KiB"},
                                                  {"cluster.icache.shared_size=64KiB"},
                                                  {"cluster.icache.shared_banks=4"},
                                                  {"cluster.icache.ways=8"},
                                                  {"cluster.icache.ways=16"},
                                                  {"cluster.icache.shared_hit=0"},
                                                  {"cluster.icache.shared_hit=1"},
                                                  {"cluster.icache.refill_width=16"},
                                                  {"cluster.icache.refills=4"},
                                                  {"cluster.fpu.int64_units=8"},
                                                  {"cluster.dma.commands=16"},
                                                  {"controller.icache.refill_width=16"},
                                                  {"cluster.dma.bytes_per_cycle=16"},
                                                  {"cluster.dma.bytes_per_cycle=64"},
                                                  {"cluster.l1.size=1MiB"},
                                                  {"cluster.l1.banks=32"},
                                                  {"controller.icache.size=8KiB"},
                                                  {"l2.size=16MiB"}};

sim::DomainEnergies idle_second(const sim::ChipConfig& chip) {
  return sim::energy_of(sim::idle_activity(chip, chip.cluster.workers, Seconds(1)), chip);
}

// More hardware costs area, and leakage and clock even if nothing uses it.
TEST(Area, NoHardwareIsFree) {
  const sim::ChipConfig before = load_platform("gap9");
  for (const auto& more : kMore) {
    const sim::ChipConfig after = load_platform("gap9", more);
    EXPECT_GT(sim::total_area(after).area, sim::total_area(before).area) << more[0];
    EXPECT_GT(idle_second(after).total().value, idle_second(before).total().value) << more[0];
  }
}

/// Whatever the other sizes are, the next larger one never shrinks the chip.
TEST(Area, ALargerResourceNeverShrinksTheChip) {
  const auto grows = [](const char* key, const std::vector<std::string>& values,
                        const std::vector<std::string>& beside) {
    double before = 0;
    for (const std::string& value : values) {
      std::vector<std::string> overrides = beside;
      overrides.push_back(fmt::format("{}={}", key, value));
      const double now = sim::total_area(load_platform("gap9", overrides)).area.count();
      EXPECT_GT(now, before) << key << '=' << value;
      before = now;
    }
  };
  const std::vector<std::string> sizes{"256B", "512B", "1KiB", "1536B", "2KiB",
                                       "3KiB", "4KiB", "8KiB", "64KiB"};
  for (const char* ways : {"1", "4", "16"}) {
    const std::vector<std::string> beside{fmt::format("cluster.icache.ways={}", ways)};
    grows("cluster.icache.size", sizes, beside);
    grows("cluster.icache.master_size", sizes, beside);
    grows("cluster.icache.shared_size", {"1KiB", "2KiB", "4KiB", "16KiB", "64KiB"}, beside);
    grows("cluster.icache.shared_banks", {"1", "2", "4", "8"}, beside);
  }
  grows("controller.icache.size", sizes, {});
  grows("cluster.icache.ways", {"1", "2", "4", "8", "16"}, {"cluster.icache.size=2KiB"});
  grows("cluster.dma.bytes_per_cycle", {"2", "4", "8", "16", "32", "64"}, {});
  grows("cluster.icache.refill_width", {"8", "12", "16"}, {});
  grows("cluster.icache.shared_hit", {"2", "1.5", "1", "0"}, {});
}

/// A core without Xpulp is smaller by it, in the cluster and as the controller.
TEST(Area, CoresWithoutExtensionsAreSmaller) {
  const auto gates = [](const std::vector<std::string>& overrides) {
    const sim::GatesByDomain all = sim::gates_by_domain(load_platform("gap9", overrides));
    return std::pair(all[sim::index(sim::Domain::Cores)].count(),
                     all[sim::index(sim::Domain::Controller)].count());
  };
  const auto [cores, controller] = gates({});
  const auto [plain_cores, plain_controller] = gates({"isa.base=rv32imfc"});
  EXPECT_NEAR(cores - plain_cores, 9 * 10, 1e-9);
  EXPECT_NEAR(controller - plain_controller, 10, 1e-9);
}

TEST(Area, AnAcceleratorThatNobodyKnowsTheSizeOfIsNotNothing) {
  const sim::AreaItem eigen = sim::total_area(load_platform("gap9-eigen"));
  EXPECT_FALSE(eigen.known);
  EXPECT_TRUE(sim::total_area(load_platform("gap9-hamming")).known);
}

/// Powers of a chip that does nothing, its clocks left out [W].
struct Leakage {
  double cluster = 0;
  double all = 0;
};
Leakage leakage_at(const char* name) {
  sim::ChipConfig chip = load_platform(name);
  for (sim::EnergyConfig* e : {&chip.energy.value, &chip.energy.low, &chip.energy.high})
    e->by_size.gate_cycle = e->by_size.bank_cycle = Joules(0);
  const sim::DomainEnergies e = idle_second(chip);
  Leakage leakage{0, e.total().value.count()};
  for (const sim::DomainInfo& info : sim::kDomains)
    if (sim::is_of_cluster(info.domain)) leakage.cluster += e[info.domain].value.count();
  return leakage;
}

// 1.52 mW of the cluster at 0.65 V (FACTS.md#energy-per-event). Of the whole chip two points were
// measured (FACTS.md#measured-power); solved for s V, as there, they give 2.85 mW in the mean.
TEST(EnergyBySize, LeakageIsThatOfThePublishedTotals) {
  const Leakage slow = leakage_at("gap9-240mhz");
  const Leakage fast = leakage_at("gap9");
  EXPECT_NEAR(slow.cluster, 1.52e-3, 0.15e-3);
  const double ratio = 0.80 / 0.65;
  const double slow_v2f = 0.65 * 0.65 * 240;
  const double a = (fast.all - slow.all * ratio) / (0.80 * 0.80 * 370 - slow_v2f * ratio);
  EXPECT_NEAR(slow.all - a * slow_v2f, 2.85e-3, 0.05e-3);
}

TEST(EnergyBySize, FixedAmountsBesideItAreRefused) {
  expect_parts(fault_of([] { load_platform("gap9", {"energy.cluster.leakage=2mW"}); }),
               {"energy.cluster.leakage is 2 mW (-p", "area.", "by size (energy.by_size)"});
  expect_parts(fault_of([] { load_platform("gap8", {"energy.by_size.gate_cycle=12fJ"}); }),
               {"energy.by_size.gate_cycle", "the section area"});
  expect_parts(fault_of([] { load_platform("gap8", {"area.core=48kGE"}); }),
               {"area.core is 48 kGE", "area.gate is missing", "in full, or none"});
}

}  // namespace
}  // namespace leviosim::platform
