// How often cores meet at banks and units, as GAP9 has it, against cores that are stepped through
// cycle by cycle (FACTS.md#collisions).
#include <gtest/gtest.h>

#include <random>

#include "platform_models/loader/loader.h"
#include "sim/chip/contention.h"
#include "tests/support/stepped_sharing.h"

namespace leviosim::platform {
namespace {

TEST(Collisions, OfStreamsAreThoseOfLoopsSteppedThrough) {
  const sim::L1Config l1 = load_platform("gap9").cluster.l1;
  constexpr int kCores = 8;
  std::mt19937 random(1);
  double stalls = 0;
  double scattered = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto loops = leviosim::testing::StreamLoops::draw(random, kCores);
    const auto lost = leviosim::testing::step_streams(loops, kCores, l1.banks);
    stalls += lost.stalls;
    scattered += (kCores - 1) * lost.accesses * lost.accesses / (2 * l1.banks);
  }
  EXPECT_NEAR(stalls / scattered, l1.stream_conflicts, 0.1);
}

TEST(Collisions, OfTwoCoresInOneLoopAreThoseOfPairsSteppedThrough) {
  const double collisions = load_platform("gap9").cluster.fpu.collisions;
  std::mt19937 random(1);
  double lost = 0;
  double by_chance = 0;
  for (const std::size_t size : {16, 40, 100})
    for (int i = 0; i < 60; ++i) {
      const std::size_t uses = 1 + random() % (size / 2);
      const auto loop = leviosim::testing::draw_loop(random, size, uses);
      const double density = static_cast<double>(uses) / static_cast<double>(size);
      for (std::size_t phase = 0; phase < size; phase += 1 + size / 16) {
        const auto pair = leviosim::testing::step_pair(loop, loop, phase, 2000);
        lost += (pair[0] + pair[1]) / 2;
        by_chance += sim::collisions_by_chance(density, density);
      }
    }
  EXPECT_NEAR(lost / by_chance, collisions, 0.1);
}

/// At any phase.
TEST(Collisions, OfTwoCoresWithRunsOfOperationsAreThoseOfPairsSteppedThrough) {
  for (const auto& [others, run] : {std::pair(6, 8), std::pair(2, 1), std::pair(4, 2),
                                    std::pair(3, 3), std::pair(12, 8), std::pair(16, 8)}) {
    const auto length = static_cast<std::size_t>(others + run);
    const auto loop = leviosim::testing::loop_with_run(static_cast<std::size_t>(others),
                                                       static_cast<std::size_t>(run));
    double lost = 0;
    for (std::size_t phase = 0; phase < length; ++phase) {
      const auto pair = leviosim::testing::step_pair(loop, loop, phase, 20'000);
      lost += (pair[0] + pair[1]) / 2 / static_cast<double>(length);
    }
    const double share = run / static_cast<double>(length);
    EXPECT_NEAR(lost, sim::collisions_in_runs(share, run, share, run), 0.01)
        << others << " and " << run;
  }
}

/// Loops of other lengths and on other numbers of cores, whose lengths vary by a third.
TEST(Collisions, QueuesOfADividerAreThoseOfCoresSteppedThrough) {
  sim::ClusterConfig cluster = load_platform("gap9").cluster;
  std::mt19937 random(1);
  for (const int others : {40, 69, 120, 300})
    for (const int cores : {1, 2, 4, 8}) {
      constexpr int kBusy = 14;
      const double stepped =
          leviosim::testing::step_divider(random, cores, others, others / 3, kBusy);
      std::vector<sim::Runner> runners;
      const double lone = others + kBusy;
      for (int core = 0; core < cores; ++core) {
        sim::Runner& runner = runners.emplace_back();
        runner.core = core;
        runner.units[static_cast<std::size_t>(sim::Unit::Divider)] = {1 / lone, kBusy / lone};
      }
      std::vector<sim::Progress> progress;
      sim::Contention(cluster).solve(runners, progress);
      EXPECT_NEAR(lone / progress[0].rate / stepped, 1, 0.1) << others << " on " << cores;
    }
}

/// Nineteen operations of a unit, some of them in a row: how long two cores take depends on when
/// they begin. The mean of the phases is what the model has; its band holds them all.
TEST(Collisions, ThePhaseDecidesWhatTheMeanLeavesOpen) {
  std::mt19937 random(5);
  const auto loop = leviosim::testing::draw_loop(random, 40, 19);
  const double chance = sim::collisions_by_chance(19.0 / 40, 19.0 / 40);
  double mean = 0;
  double least = 1;
  double most = 0;
  for (std::size_t phase = 0; phase < 40; ++phase) {
    const auto pair = leviosim::testing::step_pair(loop, loop, phase, 4000);
    const double lost = (pair[0] + pair[1]) / 2;
    mean += lost / 40;
    least = std::min(least, lost);
    most = std::max(most, lost);
  }
  EXPECT_NEAR(mean, chance, 0.25 * chance);
  EXPECT_LT(least, 0.8 * chance);
  EXPECT_GT(most, 1.2 * chance);
}

}  // namespace
}  // namespace leviosim::platform
