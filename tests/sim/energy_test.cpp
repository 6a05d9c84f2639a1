// Energy against closed formulas, and what the voltage and the clock do to it.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/work/op.h"
#include "tests/sim/energy_test_config.h"

namespace leviosim::sim {
namespace {

using work::Counts;
using work::Op;

Counts counts_of(Op op, std::uint64_t n) {
  Counts counts;
  counts[op] = n;
  return counts;
}

/// An account in which the team did nothing but work of its own.
MechanismCycles busy(double core_cycles) {
  MechanismCycles breakdown;
  breakdown[Mechanism::Issue] = core_cycles;
  return breakdown;
}

double joules(const DomainEnergies& energies, Domain domain) {
  return energies[domain].value.count();
}

/// A stage with something of everything.
DomainEnergies mixed_stage(const ChipConfig& chip) {
  Counts counts = counts_of(Op::IntAlu, 8'000'000);
  counts[Op::LoadStream] = 2'000'000;
  counts[Op::F32Fma] = 1'000'000;
  counts[Op::LoadL2] = 50'000;
  MechanismCycles breakdown = busy(11'000'000);
  breakdown[Mechanism::Imbalance] = 1'000'000;
  return energy_of(
      cluster_activity(chip, 8, counts, {3, Bytes(4000), Bytes(0)}, breakdown, Cycles(1'500'000)),
      chip);
}

// One of nine cores issues N instructions in T cycles at f; the others wait.
TEST(Energy, OneCoreThatIssuesInstructions) {
  const double N = 3'000'000;
  const double T = 4'000'000;
  const double f = 1e8;
  const ChipConfig chip = energy_chip();
  const DomainEnergies e = energy_of(
      cluster_activity(chip, 1, counts_of(Op::IntAlu, 3'000'000), {}, busy(T), Cycles(4'000'000)),
      chip);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Cores), N * 5e-12 + T / f * (40e-6 + 8 * 2e-6));
  EXPECT_EQ(joules(e, Domain::Fpu), 0);
  EXPECT_DOUBLE_EQ(joules(e, Domain::L1), T / f * 16 * 5e-6);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Dma), T * 0.4e-12 + T / f * 10e-6);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Cluster), T * 12e-12 + T / f * 1e-3);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Controller), T / f * 2e-6);
  EXPECT_EQ(joules(e, Domain::L2), 0);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Soc), T * 20e-12 + T / f * 3e-3);
}

TEST(Energy, DomainsAreTheTotal) {
  const DomainEnergies e = mixed_stage(energy_chip());
  double sum = 0;
  EXPECT_EQ(domains_of(e).size(), kDomainCount - 1);  // nothing lies in external memory
  for (const DomainInfo& info : domains_of(e)) {
    EXPECT_GT(joules(e, info.domain), 0) << info.name;
    sum += joules(e, info.domain);
  }
  EXPECT_DOUBLE_EQ(e.total().value.count(), sum);
}

// Of its bytes, and of the time for which it keeps something, whatever the chip's voltage.
TEST(Energy, ExternalMemoryTakesPartWhereSomethingLiesThere) {
  ChipConfig chip = energy_chip();
  chip.energy.value.external = {Joules(1e-9), Watts(0.25)};
  chip.energy.low.external = chip.energy.high.external = chip.energy.value.external;
  const work::Transferred moved{0, Bytes(0), Bytes(5000)};
  Activity activity = controller_activity(chip, {}, moved, Cycles(0));
  activity.external_on = Seconds(2);
  chip.supply.voltage = chip.energy.value.voltage * 0.5;
  const DomainEnergies e = energy_of(activity, chip);
  EXPECT_DOUBLE_EQ(joules(e, Domain::External), 5000 * 1e-9 + 2 * 0.25);
  EXPECT_EQ(domains_of(e).size(), kDomainCount);
  EXPECT_EQ(domains_of(e).back().name, "external");
}

TEST(Energy, FloatingPointUnitsAddToTheInstruction) {
  const ChipConfig chip = energy_chip();
  Counts counts = counts_of(Op::F32Add, 700);
  counts[Op::F32Div] = 300;
  counts[Op::F64Add] = 500;  // by instructions, on the core
  const DomainEnergies e =
      energy_of(cluster_activity(chip, 8, counts, {}, MechanismCycles{}, Cycles(0)), chip);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Fpu), 1000 * 4e-12);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Cores), 1500 * 5e-12);
}

TEST(Energy, TransfersAccessBothMemories) {
  const ChipConfig chip = energy_chip();
  const DomainEnergies e = energy_of(
      cluster_activity(chip, 8, {}, {2, Bytes(8000), Bytes(400)}, MechanismCycles{}, Cycles(0)),
      chip);
  EXPECT_DOUBLE_EQ(joules(e, Domain::L1), 2000 * 2e-12);
  EXPECT_DOUBLE_EQ(joules(e, Domain::L2), 2100 * 10e-12);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Dma), (2 * 16 + 1000) * 0.8e-12);
}

TEST(Energy, AccessesOfCoresGoWhereTheirDataAre) {
  const ChipConfig chip = energy_chip();
  Counts counts = counts_of(Op::LoadStream, 10);
  counts[Op::StoreIndexed] = 20;
  counts[Op::Straddle] = 5;
  counts[Op::LoadShared] = 7;
  counts[Op::LoadL2] = 3;
  const auto cluster = cluster_activity(chip, 8, counts, {}, MechanismCycles{}, Cycles(0));
  EXPECT_EQ(cluster.l1_accesses, 42);
  EXPECT_EQ(cluster.l2_accesses, 3);
  const auto controller = controller_activity(chip, counts, {}, Cycles(100));
  EXPECT_EQ(controller.l1_accesses, 0);
  EXPECT_EQ(controller.l2_accesses, 45);
}

TEST(Energy, RefillsOfInstructionCachesAccessL2) {
  ChipConfig chip = energy_chip();
  chip.cluster.icache = {Bytes(16), Bytes(512), Bytes(2048), Bytes(4096), 2, 2, 20, 1};
  Counts counts;
  counts.code[work::kNeverFetched] = 1600;
  const auto one = cluster_activity(chip, 1, counts, {}, MechanismCycles{}, Cycles(0));
  EXPECT_DOUBLE_EQ(one.l2_accesses, 400);  // 100 lines of four words
}

TEST(Energy, WhileTheMasterWorksAloneTheWorkersAreGated) {
  const ChipConfig chip = energy_chip();
  MechanismCycles breakdown;
  breakdown[Mechanism::Serial] = 8 * 1000;
  const auto serial = cluster_activity(chip, 8, {}, {}, breakdown, Cycles(1000));
  EXPECT_DOUBLE_EQ(serial.cores_working.count(), 1000 / 1e8);
  EXPECT_DOUBLE_EQ(serial.cores_gated.count(), 8 * 1000 / 1e8);
  breakdown = {};
  breakdown[Mechanism::Imbalance] = 500;
  breakdown[Mechanism::Synchronisation] = 300;
  breakdown[Mechanism::Transfer] = 200;
  EXPECT_NEAR(cluster_activity(chip, 1, {}, {}, breakdown, Cycles(1000)).cores_working.count(), 0,
              1e-18);
}

TEST(Energy, TheControllerAddsOnlyItself) {
  const ChipConfig chip = energy_chip();
  Counts counts = counts_of(Op::IntAlu, 1000);
  counts[Op::F32Mul] = 200;
  const DomainEnergies e = energy_of(controller_activity(chip, counts, {}, Cycles(2000)), chip);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Controller),
                   1200 * 5e-12 + 200 * 4e-12 + 2000 / 1e8 * (40e-6 - 2e-6));
  EXPECT_DOUBLE_EQ(e.total().value.count(), joules(e, Domain::Controller));
}

TEST(Energy, AnIdleClusterKeepsAShareOfItsClock) {
  const ChipConfig chip = energy_chip();
  const DomainEnergies e = energy_of(idle_activity(chip, 8, Seconds(0.01)), chip);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Cluster), 0.5 * 1e6 * 12e-12 + 0.01 * 1e-3);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Cores), 0.01 * 9 * 2e-6);
  EXPECT_DOUBLE_EQ(joules(e, Domain::Soc), 1e6 * 20e-12 + 0.01 * 3e-3);
}

// P = a V² f + s V.
TEST(Energy, DynamicEnergyGrowsWithTheSquareOfTheVoltageAndStaticEnergyWithTheVoltage) {
  ChipConfig dynamic = energy_chip();
  for (EnergyConfig* e : {&dynamic.energy.value, &dynamic.energy.low, &dynamic.energy.high}) {
    e->core.leakage = e->core.gated_leakage = e->l1.bank_leakage = e->dma.leakage = Watts(0);
    e->cluster.leakage = e->soc.static_power = Watts(0);
  }
  const ChipConfig both = energy_chip();
  const auto total_at = [](ChipConfig chip, double volts) {
    chip.supply.voltage = Volts(volts);
    return mixed_stage(chip).total().value.count();
  };
  const double dynamic_part = total_at(dynamic, 1);
  const double static_part = total_at(both, 1) - dynamic_part;
  EXPECT_GT(static_part, 0);
  for (const double volts : {0.65, 0.8, 1.25}) {
    EXPECT_DOUBLE_EQ(total_at(dynamic, volts), volts * volts * dynamic_part);
    EXPECT_NEAR(total_at(both, volts), volts * volts * dynamic_part + volts * static_part, 1e-15);
  }
}

// A clock changes how long static power flows, and nothing else about the energy of a task.
TEST(Energy, AClockChangeLeavesTheEnergyOfEventsAndCyclesAlone) {
  const ChipConfig fast = energy_chip();
  ChipConfig slow = fast;
  slow.cluster.clock = slow.controller.clock = Hertz(25'000'000);
  const DomainEnergies quick = mixed_stage(fast);
  const DomainEnergies leisurely = mixed_stage(slow);
  for (const Domain domain : {Domain::Fpu, Domain::L2})
    EXPECT_DOUBLE_EQ(joules(leisurely, domain), joules(quick, domain));
  const double dynamic_part = 1.5e6 * 12e-12;
  EXPECT_DOUBLE_EQ(joules(leisurely, Domain::Cluster) - dynamic_part,
                   4 * (joules(quick, Domain::Cluster) - dynamic_part));
  const double instructions = 11.05e6 * 5e-12;
  EXPECT_NEAR(joules(leisurely, Domain::Cores) - instructions,
              4 * (joules(quick, Domain::Cores) - instructions), 1e-15);
  // Power of what is clocked is proportional to the clock.
  EXPECT_DOUBLE_EQ(dynamic_part / (1.5e6 / 1e8), 4 * dynamic_part / (1.5e6 / 25e6));
}

TEST(Energy, OfTwoStagesIsThatOfBothTogether) {
  const ChipConfig chip = energy_chip();
  Activity a = cluster_activity(chip, 8, counts_of(Op::F32Add, 1000), {1, Bytes(64), Bytes(8)},
                                busy(900), Cycles(300));
  const Activity b = controller_activity(chip, counts_of(Op::F32Mul, 500), {}, Cycles(700));
  const Activity c = idle_activity(chip, 8, Seconds(1e-4));
  DomainEnergies sum = energy_of(a, chip);
  sum += energy_of(b, chip);
  sum += energy_of(c, chip);
  a += b;
  a += c;
  const DomainEnergies together = energy_of(a, chip);
  for (const DomainInfo& info : kDomains)
    EXPECT_NEAR(joules(together, info.domain), joules(sum, info.domain), 1e-18) << info.name;
}

TEST(EnergyBand, NumbersWithoutRangeHaveNoBand) {
  const Estimate<Joules> total = mixed_stage(energy_chip()).total();
  EXPECT_EQ(total.low(), total.value);
  EXPECT_EQ(total.high(), total.value);
}

TEST(EnergyBand, OneSourceAddsUpAndSourcesCombineAsRootSumSquare) {
  ChipConfig chip = energy_chip();
  chip.energy.low.core.instruction = Joules(4e-12);   // of the table
  chip.energy.high.l1.access = Joules(3e-12);         // also of the table
  chip.energy.high.core.instruction = Joules(7e-12);  // so these two go up together
  chip.energy.high.l2.access = Joules(16e-12);
  Counts counts = counts_of(Op::LoadStream, 1000);
  counts[Op::LoadL2] = 500;
  const Estimate<Joules> total =
      energy_of(cluster_activity(chip, 8, counts, {}, MechanismCycles{}, Cycles(0)), chip).total();
  EXPECT_NEAR(total.value.count() - total.low().count(), 1500 * 1e-12, 1e-20);
  EXPECT_NEAR(total.high().count() - total.value.count(),
              std::hypot(1500 * 2e-12 + 1000 * 1e-12, 500 * 6e-12), 1e-20);
}

TEST(EnergyBand, OfASumIsNoWiderThanTheBandsOfItsParts) {
  ChipConfig chip = energy_chip();
  chip.energy.high.core = {Joules(6e-12), Joules(8e-12), Watts(50e-6), Watts(3e-6)};
  chip.energy.high.soc = {Joules(40e-12), Watts(4e-3)};
  const DomainEnergies e = mixed_stage(chip);
  double parts = 0;
  for (const DomainInfo& info : kDomains)
    parts += (e[info.domain].high() - e[info.domain].value).count();
  const double whole = (e.total().high() - e.total().value).count();
  EXPECT_GT(whole, 0);
  EXPECT_LT(whole, parts);
}

TEST(EnergyBand, DoesNotGoBelowZero) {
  Estimate<Joules> e;
  e.value = Joules(1);
  e.down[0] = e.down[1] = Joules(1);
  EXPECT_EQ(e.low(), Joules(0));
}

TEST(Energy, PlatformsWithoutFiguresAreKnown) {
  EXPECT_FALSE(knows_energy(test_chip()));
  EXPECT_TRUE(knows_energy(energy_chip()));
}

}  // namespace
}  // namespace leviosim::sim
