// How a unit that is too small is shared: whoever asks for less than a fair share gets it, and the
// others share the rest.
#include "sim/chip/contention.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <random>

#include "tests/sim/chip_test_config.h"
#include "tests/support/stepped_sharing.h"

namespace leviosim::sim {
namespace {

Runner asking(int core, Unit unit, double requests, double busy) {
  Runner runner;
  runner.core = core;
  runner.units[static_cast<std::size_t>(unit)] = {requests, requests * busy};
  return runner;
}

TEST(Contention, ALightUserOfTheDividerIsServedAndTheOthersShareTheRest) {
  Contention contention(test_cluster());
  std::vector<Progress> progress;
  contention.solve({asking(0, Unit::Divider, 0.01, 10), asking(1, Unit::Divider, 0.1, 10),
                    asking(2, Unit::Divider, 0.1, 10)},
                   progress);
  EXPECT_NEAR(progress[0].rate, 1, 1e-9);  // a tenth of the divider
  for (const std::size_t i : {1, 2}) {
    EXPECT_NEAR(progress[i].rate, 0.45, 1e-9);  // of the nine tenths that are left, a half each
    EXPECT_NEAR(progress[i].lost[Mechanism::Divider], 0.55, 1e-9);
  }
}

TEST(Contention, RequestsOfDifferentLengthTakeTurns) {
  Contention contention(test_cluster());
  std::vector<Progress> progress;
  contention.solve({asking(0, Unit::Divider, 0.1, 5), asking(1, Unit::Divider, 0.1, 10)}, progress);
  // In turns of 5 and 10 cycles each makes one request every 15.
  for (const Progress& p : progress) EXPECT_NEAR(p.rate, 10.0 / 15, 1e-9);
}

TEST(Contention, AWaitForABankAddsToThatForBanksOnAverage) {
  Contention contention(test_cluster());
  std::vector<Progress> progress;
  Runner a = asking(0, Unit::Bank, 0.8, 1), b = asking(1, Unit::Bank, 0.8, 1);
  a.scattered = b.scattered = 0.2;
  contention.solve({a, b}, progress);
  for (const Progress& p : progress) {
    EXPECT_NEAR(p.rate, 1 / 1.6, 1e-6);
    EXPECT_NEAR(p.rate + p.lost[Mechanism::Banks], 1, 1e-6);
  }
}

// ---- units that are not saturated ----

ClusterConfig with_collisions(double collisions) {
  ClusterConfig config = test_cluster();
  config.fpu.collisions = collisions;
  return config;
}

TEST(Contention, TwoCoresInRandomOrderCollideAtTheirUnit) {
  std::vector<Progress> progress;
  for (const double density : {0.1, 0.2, 0.5, 0.8, 1.0})
    for (const Unit unit : {Unit::Fpu, Unit::Int64}) {
      // Cores 0 and 4 share a unit, core 1 has one of its own.
      const std::vector<Runner> runners = {asking(0, unit, density, 1), asking(1, unit, density, 1),
                                           asking(4, unit, density, 1)};
      const double lost = density * density / (2 * (1 - density) + density * density);
      Contention(with_collisions(1)).solve(runners, progress);
      for (const std::size_t i : {0, 2}) {
        EXPECT_NEAR(progress[i].rate, 1 / (1 + lost), 1e-6) << density;
        EXPECT_NEAR(progress[i].rate + progress[i].lost[Mechanism::Fpu], 1, 1e-6);
      }
      EXPECT_NEAR(progress[1].rate, 1, 1e-9);
      Contention(with_collisions(0.5)).solve(runners, progress);
      EXPECT_NEAR(progress[0].rate, std::min(1 / (1 + 0.5 * lost), 0.5 / density), 1e-6) << density;
      Contention(with_collisions(0)).solve(runners, progress);
      EXPECT_NEAR(progress[0].rate, std::min(1.0, 0.5 / density), 1e-6) << density;
    }
}

TEST(Contention, ACoreThatIsHeldBackElsewhereCollidesLess) {
  const auto rate_beside = [](double rate_of_other) {
    Runner other = asking(4, Unit::Fpu, 0.4, 1);
    other.units[static_cast<std::size_t>(Unit::Bank)] = {1 / rate_of_other, 1 / rate_of_other};
    std::vector<Progress> progress;
    Contention(with_collisions(1)).solve({asking(0, Unit::Fpu, 0.4, 1), other}, progress);
    return progress[0].rate;
  };
  EXPECT_NEAR(rate_beside(1), 1 / (1 + collisions_by_chance(0.4, 0.4)), 0.02);
  EXPECT_NEAR(rate_beside(0.5), 1 / (1 + collisions_by_chance(0.4, 0.2)), 0.01);
}

TEST(Contention, AnyUnitForAnyCoreLeavesChanceOut) {
  ClusterConfig config = with_collisions(1);
  config.fpu.mapping = FpuMapping::Dynamic;
  std::vector<Progress> progress;
  Contention(config).solve({asking(0, Unit::Fpu, 0.5, 1), asking(4, Unit::Fpu, 0.5, 1)}, progress);
  EXPECT_NEAR(progress[0].rate, 1, 1e-9);
}

/// Two cores stepped through cycle by cycle, with operations in random order.
TEST(Contention, ChanceIsThatOfCoresThatAreSteppedThrough) {
  std::mt19937 random(1);
  for (const auto& [mine, other] :
       {std::pair(20, 20), std::pair(40, 40), std::pair(60, 60), std::pair(90, 30)}) {
    double lost_by_first = 0;
    double lost_by_second = 0;
    constexpr int kLoops = 40;
    for (std::size_t i = 0; i < kLoops; ++i) {
      // Of lengths without a common divisor, so that all phases come.
      const auto first = leviosim::testing::draw_loop(random, 200, 2 * mine);
      const auto second = leviosim::testing::draw_loop(random, 201, 2 * other);
      const auto lost = leviosim::testing::step_pair(first, second, 5 * i, 20'000);
      lost_by_first += lost[0] / kLoops;
      lost_by_second += lost[1] / kLoops;
    }
    EXPECT_NEAR(lost_by_first, collisions_by_chance(mine / 100.0, other / 100.0), 0.03) << mine;
    EXPECT_NEAR(lost_by_second, collisions_by_chance(other / 100.0, mine / 100.0), 0.05) << mine;
    EXPECT_NEAR(lost_by_first + lost_by_second,
                collisions_by_chance(mine / 100.0, other / 100.0) +
                    collisions_by_chance(other / 100.0, mine / 100.0),
                0.08 * (lost_by_first + lost_by_second))
        << mine;
  }
}

/// Cycles from one call to the next of cores that call units which take `busy` cycles, first come,
/// first served, and do other things between for times by chance.
double cycles_per_call(int cores, int units, double busy, double between, std::mt19937& random) {
  constexpr int kCalls = 20'000;
  std::exponential_distribution<double> other_work(1 / between);
  using Times = std::priority_queue<double, std::vector<double>, std::greater<>>;
  Times calls, free;
  for (int i = 0; i < cores; ++i) calls.push(other_work(random));
  for (int i = 0; i < units; ++i) free.push(0);
  double end = 0;
  for (int i = 0; i < kCalls; ++i) {
    end = std::max(calls.top(), free.top()) + busy;
    calls.pop();
    free.pop();
    free.push(end);
    calls.push(end + other_work(random));
  }
  return end * cores / kCalls;
}

TEST(Contention, CallsQueueAsThoseOfCoresThatAreSteppedThrough) {
  std::mt19937 random(3);
  ClusterConfig config = with_collisions(1);
  constexpr double kBusy = 20;
  const Unit accelerator = accelerator_of(work::OffloadKind::Hamming);
  for (const int units : {1, 2})
    for (const int cores : {2, 4, 8})
      for (const double load : {0.3, 0.5, 0.7, 1.2}) {
        const double between = cores * kBusy / units / load - kBusy;
        if (between <= 0) continue;
        const double expected = cycles_per_call(cores, units, kBusy, between, random);
        config.accelerators[work::index(work::OffloadKind::Hamming)] = {.units = units};
        config.fpu.dividers = units;
        for (const Unit unit : {accelerator, Unit::Divider}) {
          const std::string where = fmt::format("{} cores, {} units, {}", cores, units, load);
          std::vector<Runner> runners;
          for (int i = 0; i < cores; ++i)
            runners.push_back(asking(i, unit, 1 / (between + kBusy), kBusy));
          std::vector<Progress> progress;
          Contention(config).solve(runners, progress);
          const Progress& p = progress[0];
          EXPECT_NEAR((between + kBusy) / p.rate / expected, 1,
                      units == 1 && load < 1 ? 0.04 : 0.12)
              << where;
          EXPECT_NEAR(p.rate + p.lost[unit == accelerator ? Mechanism::AcceleratorContention
                                                          : Mechanism::Divider],
                      1, 1e-6)
              << where;
        }
      }
}

TEST(Contention, StreamsConflictAsAShareOfScatteredAccesses) {
  ClusterConfig config = test_cluster();
  std::vector<Progress> progress;
  for (const double conflicts : {0.0, 0.5, 1.0}) {
    config.l1.stream_conflicts = conflicts;
    std::vector<Runner> runners(8);
    for (std::size_t i = 0; i < 8; ++i) {
      runners[i].core = static_cast<int>(i);
      runners[i].streamed = 0.5;
    }
    Contention(config).solve(runners, progress);
    // r = 1 / (1 + k r) with k = conflicts 7 p^2 / 32.
    const double k = conflicts * 7 * 0.25 / 32;
    const double rate = k == 0 ? 1 : (-1 + std::sqrt(1 + 4 * k)) / (2 * k);
    for (const Progress& p : progress) {
      EXPECT_NEAR(p.rate, rate, 1e-6);
      EXPECT_NEAR(p.lost[Mechanism::Banks], 1 - rate, 1e-6);
    }
  }
}

// ---- the solution ----

/// The rates of runners that no unit holds back: the equations one by one, each step half of what
/// they ask for, until nothing changes.
std::vector<double> damped_rates(const std::vector<Runner>& runners, const ClusterConfig& config,
                                 double dma_words) {
  const std::size_t n = runners.size();
  const double collisions = config.fpu.collisions;
  constexpr auto kFpu = static_cast<std::size_t>(Unit::Fpu);
  constexpr auto kDivider = static_cast<std::size_t>(Unit::Divider);
  std::vector<double> rate(n, 1), colliding(n, 0), waiting(n, 0);
  for (int round = 0; round < 20'000; ++round) {
    const std::vector<double> before = rate, collided = colliding, waited = waiting;
    const auto asked = [&](std::size_t i) {
      return std::min(1.0, runners[i].units[kFpu].cycles * before[i] * (1 + collided[i]));
    };
    for (std::size_t i = 0; i < n; ++i) {
      const Runner& me = runners[i];
      double lost = 0, behind = 0, banks = me.scattered * dma_words, code = 0;
      banks += me.streamed * dma_words;
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        const Runner& other = runners[j];
        if (me.core % config.fpu.units == other.core % config.fpu.units)
          lost += me.units[kFpu].run > 0 && other.units[kFpu].run > 0
                      ? collisions_in_runs(asked(i), me.units[kFpu].run, asked(j),
                                           other.units[kFpu].run)
                      : collisions_by_chance(asked(i), asked(j));
        const UnitDemand& divisions = other.units[kDivider];
        if (divisions.requests > 0)
          behind += queued_behind(
              {divisions.requests * before[j], divisions.cycles / divisions.requests, waited[j]});
        const double streamed = other.streamed * before[j], scattered = other.scattered * before[j];
        banks += me.scattered * (scattered + streamed) +
                 me.streamed * (scattered + config.l1.stream_conflicts * streamed);
        code += me.fetches * other.fetches * before[j];
      }
      const double pace = before[i] * (1 + collided[i]);
      colliding[i] = (collided[i] + collisions * lost / pace) / 2;
      waiting[i] = (waited[i] + collisions * behind) / 2;
      rate[i] = (before[i] + 1 / (1 + banks / (2.0 * config.l1.banks) +
                                  code / (2.0 * config.icache.shared_banks) + colliding[i] +
                                  me.units[kDivider].requests * waiting[i])) /
                2;
    }
  }
  return rate;
}

/// Runners that do not ask any unit for more than it has, most of the divider nearly so.
std::vector<Runner> random_runners(std::mt19937& random, const ClusterConfig& config) {
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Runner> runners;
  const int cores = 2 + static_cast<int>(random() % 8);
  for (int core = 0; core < cores; ++core) {
    Runner runner;
    runner.core = core;
    const double busy = share(random) < 0.2 ? 0 : share(random) * 0.99 / cores;
    const double length = 10 + 4 * share(random);
    if (busy > 0) runner.units[static_cast<std::size_t>(Unit::Divider)] = {busy / length, busy, 1};
    const double fpu = share(random) / (1 + cores / config.fpu.units);
    const double run = share(random) < 0.5 ? 0 : 1 + 20 * share(random);
    runner.units[static_cast<std::size_t>(Unit::Fpu)] = {fpu, fpu, run};
    runner.streamed = 0.4 * share(random);
    runner.scattered = 0.3 * share(random);
    runner.fetches = 0.1 * share(random);
    runners.push_back(runner);
  }
  return runners;
}

TEST(Contention, FindsTheFixedPointOfItsEquations) {
  std::mt19937 random(5);
  ClusterConfig config = with_collisions(1);
  config.l1.stream_conflicts = 0.9;
  config.icache.shared_banks = 2;
  Contention contention(config);
  std::vector<Progress> progress;
  constexpr int kSets = 60;
  for (int k = 0; k < kSets; ++k) {
    const std::vector<Runner> runners = random_runners(random, config);
    const double dma_words = k % 3 == 0 ? 2 : 0;
    contention.solve(runners, progress, dma_words);
    const std::vector<double> expected = damped_rates(runners, config, dma_words);
    for (std::size_t i = 0; i < runners.size(); ++i) {
      EXPECT_NEAR(progress[i].rate / expected[i], 1, 1e-7) << k << ", runner " << i;
      EXPECT_NEAR(progress[i].rate + progress[i].lost.total(), 1, 1e-7);
    }
  }
  EXPECT_LT(contention.rounds(), 9 * kSets) << "that few rounds settle it";
}

}  // namespace
}  // namespace leviosim::sim
