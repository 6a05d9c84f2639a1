// Accelerators: what a call takes is said in formulas.
#include "sim/chip/accelerator.h"

#include <gtest/gtest.h>

#include "sim/chip/chip.h"
#include "sim/energy/model.h"
#include "sim/events/process.h"
#include "sim/work/op.h"
#include "tests/sim/chip_test_config.h"
#include "tests/sim/energy_test_config.h"

namespace leviosim::sim {
namespace {

using work::Counts;
using work::OffloadKind;
using work::OffloadWork;
using work::Op;
using work::Segment;

/// `rest` instructions, and calls that a core would need `inside` instructions for in all.
Segment segment(std::uint64_t rest, std::uint64_t inside, std::uint64_t calls, std::uint64_t items,
                OffloadKind kernel = OffloadKind::Hamming) {
  return {alu(rest + inside), {{kernel, calls, items, alu(inside)}}};
}

AcceleratorConfig unit(int units, double start_up, double latency, double items_per_cycle,
                       double l1_words = 0) {
  return {units, start_up, latency, items_per_cycle, l1_words};
}

ClusterConfig cluster_with(const AcceleratorConfig& accelerator,
                           OffloadKind kernel = OffloadKind::Hamming) {
  ClusterConfig cluster = test_cluster();
  cluster.events = {};
  cluster.accelerators[work::index(kernel)] = accelerator;
  return cluster;
}

Process run_job(Cluster& cluster, const work::Job& job, JobTiming& timing) {
  timing = co_await cluster.run(job);
}

double stage_cycles(const StageTiming& timing) {
  return static_cast<double>(timing.cycles.count());
}

StageTiming time_of(const ClusterConfig& config, std::vector<work::Step> steps, int workers = 8) {
  const Timebase timebase({{"cluster", config.clock}});
  Kernel kernel;
  Cluster cluster(kernel, timebase.clock("cluster"), config, workers);
  const work::Job job{{{"stage", std::move(steps), {}}}};
  JobTiming timing;
  kernel.spawn("job", run_job(cluster, job, timing));
  kernel.run();
  return timing.stages.at(0);
}

std::int64_t serial_cycles(const ClusterConfig& config, const Segment& segment) {
  return time_of(config, {work::Serial{segment}}).cycles.count();
}

/// All workers do the same.
StageTiming together(const ClusterConfig& config, const Segment& segment, int workers) {
  return time_of(
      config, {work::Fork{"f", std::vector<Segment>(static_cast<std::size_t>(workers), segment)}},
      workers);
}

TEST(Accelerator, ACallTakesStartUpLatencyAndItems) {
  EXPECT_EQ(serial_cycles(cluster_with(unit(1, 30, 12, 0.5)), segment(100, 9999, 1, 64)),
            100 + 30 + 12 + 128);
  EXPECT_EQ(serial_cycles(cluster_with(unit(1, 30, 12, 4)), segment(0, 9999, 3, 64)),
            3 * (30 + 12) + 16);
}

TEST(Accelerator, WithoutOneTheCoreDoesTheWork) {
  EXPECT_EQ(serial_cycles(test_cluster(), segment(100, 900, 1, 64)), 1000);
  // Another kind of kernel is not served.
  EXPECT_EQ(serial_cycles(cluster_with(unit(1, 30, 12, 0.5), OffloadKind::Eigen3),
                          segment(100, 900, 1, 64)),
            1000);
}

TEST(Accelerator, WithoutOneTheDemandIsThatOfTheCounts) {
  const Segment work = segment(100, 900, 3, 64);
  const Demand a = demand_of(work, unit_cost_core(), Accelerators{});
  const Demand b = demand_of(static_cast<const Counts&>(work), unit_cost_core());
  EXPECT_EQ(a.cycles(), b.cycles());
  for (std::size_t u = 0; u < kUnitCount; ++u) EXPECT_EQ(a.units[u].requests, b.units[u].requests);
}

/// n cores that do nothing else keep one unit busy all the time.
TEST(Accelerator, CoresQueueForOneUnit) {
  for (const int cores : {1, 2, 4, 8})
    EXPECT_NEAR(
        stage_cycles(together(cluster_with(unit(1, 0, 0, 0.1)), segment(0, 5000, 50, 50), cores)),
        cores * 50 * 10, 1)
        << cores;
}

/// A call lasts s + l + b for a core; a unit serves one call in b. Up to (s + l + b) / b cores do
/// not wait.
TEST(Accelerator, QueueingBeginsWhenTheUnitIsSaturated) {
  constexpr double s = 30, l = 10, b = 20;
  const ClusterConfig config = cluster_with(unit(1, s, l, 1 / b));
  for (const int cores : {1, 2, 3, 4, 8}) {
    const StageTiming timing = together(config, segment(0, 5000, 100, 100), cores);
    EXPECT_NEAR(stage_cycles(timing), 100 * std::max(s + l + b, cores * b), 2) << cores;
    EXPECT_NEAR(timing.account.team[Mechanism::Accelerator], cores * 100 * (l + b), 1);
    EXPECT_NEAR(timing.account.team[Mechanism::AcceleratorContention],
                cores * 100 * std::max(0.0, cores * b - s - l - b), 20);
    EXPECT_NEAR(timing.account.total(), cores * static_cast<double>(timing.cycles.count()), 1e-6);
  }
}

TEST(Accelerator, TwoUnitsServeTwiceAsMany) {
  const auto cycles = [](int units) {
    return together(cluster_with(unit(units, 0, 0, 0.1)), segment(0, 1, 50, 50), 8).cycles.count();
  };
  EXPECT_NEAR(static_cast<double>(cycles(1)) / static_cast<double>(cycles(2)), 2, 1e-3);
  EXPECT_NEAR(static_cast<double>(cycles(1)) / static_cast<double>(cycles(8)), 8, 1e-2);
}

TEST(Accelerator, ThatTakesForEverIsNeverBetter) {
  for (const AcceleratorConfig& slow :
       {unit(8, 1e9, 0, 1), unit(8, 0, 1e9, 1), unit(8, 0, 0, 1e-9)})
    for (const std::uint64_t inside : {10, 1000, 100000})
      EXPECT_GT(serial_cycles(cluster_with(slow), segment(100, inside, 1, 64)),
                serial_cycles(test_cluster(), segment(100, inside, 1, 64)));
}

/// What it moves in L1 takes banks from the other cores.
TEST(Accelerator, TakesBanksOfL1) {
  Segment other;
  other[Op::LoadIndexed] = 1000;
  const auto cycles = [&](double words) {
    return time_of(cluster_with(unit(1, 0, 0, 0.1, words)),
                   {work::Fork{"f", {segment(0, 1, 100, 200), other}}}, 2)
        .account.team[Mechanism::Banks];
  };
  EXPECT_EQ(cycles(0), 0);
  EXPECT_GT(cycles(2), 0);
  EXPECT_GT(cycles(4), cycles(2));
}

TEST(Accelerator, OfTheControllerServesItsCalls) {
  ChipConfig chip = test_chip();
  chip.controller.accelerators[work::index(OffloadKind::Solve)] = unit(1, 30, 12, 2);
  // Of the cluster: another one's.
  chip.cluster.accelerators[work::index(OffloadKind::Solve)] = unit(1, 0, 0, 1e6);
  const Timebase timebase({{"controller", chip.controller.clock}});
  Kernel kernel;
  Controller controller(kernel, timebase.clock("controller"), chip.controller);
  const work::Job job{{{"s", {work::Serial{segment(7, 9999, 2, 100, OffloadKind::Solve)}}, {}}}};
  JobTiming timing;
  const auto run = [](Controller& c, const work::Job& j, JobTiming& t) -> Process {
    t = co_await c.run(j);
  };
  kernel.spawn("job", run(controller, job, timing));
  kernel.run();
  EXPECT_EQ(timing.stages.at(0).cycles.count(), 7 + 2 * (30 + 12) + 50);
}

TEST(Accelerator, SharesOfSeveralWorkersAreOneWorkSegment) {
  // Eight shares on two workers: each has the calls of four.
  const ClusterConfig config = cluster_with(unit(8, 10, 0, 1));
  const std::vector<Segment> shares(8, segment(5, 100, 2, 20));
  EXPECT_NEAR(stage_cycles(time_of(config, {work::Fork{"f", shares}}, 2)), 4 * (5 + 2 * 10 + 20),
              1);
}

TEST(Accelerator, TakesItsWorkFromTheCoresEnergyAndAddsItsOwn) {
  ChipConfig chip = energy_chip();
  chip.cluster.accelerators[work::index(OffloadKind::Hamming)] = unit(1, 30, 0, 1, 4);
  chip.energy.value.cluster_accelerators[work::index(OffloadKind::Hamming)] = Joules(2e-12);
  const Segment work = segment(100, 900, 3, 64);
  const Counts left = left_to_core(work, chip.cluster.accelerators);
  EXPECT_EQ(left, alu(100));
  const Activity with =
      cluster_activity(chip, 8, left, {}, MechanismCycles{}, Cycles(0), work.offload);
  EXPECT_EQ(with.instructions, 100 + 3 * 30);
  EXPECT_EQ(with.l1_accesses, 64 * 4);
  const Activity without = cluster_activity(chip, 8, left, {}, MechanismCycles{}, Cycles(0));
  const double scale = chip.supply.voltage.count() / chip.energy.value.voltage.count();
  const auto cluster_of = [&](const Activity& a) {
    return energy_of(a, chip)[Domain::Cluster].value.count();
  };
  EXPECT_NEAR(cluster_of(with) - cluster_of(without), 64 * 2e-12 * scale * scale, 1e-18);
}

}  // namespace
}  // namespace leviosim::sim
