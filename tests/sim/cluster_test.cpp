// The cluster's steps against closed formulas, and the accounts that must add up.
#include "sim/chip/cluster.h"

#include <gtest/gtest.h>

#include "sim/chip/chip.h"
#include "sim/error.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {
namespace {

using work::Counts;
using work::Op;

Counts alu(std::uint64_t n) {
  Counts c;
  c[Op::IntAlu] = n;
  return c;
}

JobTiming run(const work::Job& job, int workers = 8, ChipConfig config = test_chip()) {
  Chip chip(config, workers);
  JobTiming timing;
  const auto body = [&]() -> Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn("test", body());
  EXPECT_EQ(chip.kernel().run(), 0U);
  return timing;
}

work::Job one_stage(std::vector<work::Step> steps) { return {{{"stage", std::move(steps), {}}}}; }

constexpr std::int64_t kForkCost = 40 + 20 + 10;  // fork_master, fork_worker, barrier

TEST(Cluster, SerialWorkTakesItsCycles) {
  const JobTiming t = run(one_stage({work::Serial{alu(1234)}}));
  EXPECT_EQ(t.stages[0].cycles.count(), 1234);
  EXPECT_EQ(t.stages[0].account.serial, 8 * 1234);
}

TEST(Cluster, TransferOfNBytes) {
  for (const std::int64_t bytes : {1, 8, 9, 19'200, 65'536}) {
    const JobTiming t = run(one_stage({work::Transfer{work::Direction::L2ToL1, Bytes(bytes)}}));
    EXPECT_EQ(t.stages[0].cycles.count(), 25 + 16 + (bytes + 7) / 8 + 8) << bytes;
  }
}

TEST(Cluster, ABarrierReleasesOnTheLastArrival) {
  work::Fork fork{"fork", {}};
  for (std::uint64_t k = 1; k <= 8; ++k) fork.shares.push_back(alu(100 * k));
  const JobTiming t = run(one_stage({fork}));
  EXPECT_EQ(t.stages[0].cycles.count(), 800 + kForkCost);
  EXPECT_EQ(t.stages[0].account.imbalance, 100 + 200 + 300 + 400 + 500 + 600 + 700);
  EXPECT_EQ(t.stages[0].account.useful.total(), 3600);
}

TEST(Cluster, OneWorkerRunsAllSharesOfEight) {
  work::Fork fork{"fork", std::vector<Counts>(8, alu(100))};
  EXPECT_EQ(run(one_stage({fork}), 1).stages[0].cycles.count(), 800 + kForkCost);
  EXPECT_EQ(run(one_stage({fork}), 3).stages[0].cycles.count(), 300 + kForkCost);
}

TEST(Cluster, TheAccountOfAStageAddsUpToItsCoreCycles) {
  std::uint64_t state = 1;
  const auto random = [&](std::uint64_t n) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state >> 33) % n;
  };
  std::vector<work::Step> steps;
  for (int k = 0; k < 40; ++k) {
    work::Fork fork{"fork", {}};
    for (int c = 0; c < 8; ++c) {
      Counts counts = alu(random(500));
      counts[Op::F32Fma] = random(3000);
      counts[Op::F32Div] = random(60);
      counts[Op::LoadStream] = random(2000);
      fork.shares.push_back(counts);
    }
    steps.emplace_back(fork);
    steps.emplace_back(work::Serial{alu(random(300))});
    steps.emplace_back(
        work::Transfer{work::Direction::L1ToL2, Bytes(static_cast<int>(random(999)))});
  }
  const StageTiming stage = run(one_stage(steps)).stages[0];
  const double core_cycles = 8.0 * static_cast<double>(stage.cycles.count());
  EXPECT_NEAR(stage.account.total(), core_cycles, 1e-9 * core_cycles);
  EXPECT_GT(stage.account.fpu, 0);
  EXPECT_GT(stage.account.divider, 0);
  EXPECT_GT(stage.account.banks, 0);
  EXPECT_GE(stage.account.rounding, 0);
  EXPECT_LT(stage.account.rounding, 8 * 40);
}

TEST(Cluster, EveryTeamSizeUpToTheEventUnitsLimit) {
  EXPECT_THROW(run(one_stage({work::Serial{alu(1)}}), 9), InputError);
  EXPECT_THROW(run(one_stage({work::Serial{alu(1)}}), 0), InputError);
}

TEST(Chip, AnOffloadCostsBothWays) {
  Chip chip(test_chip(), 8);
  JobTiming timing;
  const work::Job job = one_stage({work::Serial{alu(1000)}});
  const auto body = [&]() -> Process { timing = co_await chip.offload(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  const ClockDomain& clock = chip.timebase().clock("controller");
  EXPECT_EQ(clock.whole_cycles(timing.end - timing.begin).count(), 1000 + 2 * 300);
}

TEST(Chip, TheControllerRunsForksAsOneCore) {
  Chip chip(test_chip(), 8);
  JobTiming timing;
  const work::Job job = one_stage({work::Fork{"f", std::vector<Counts>(8, alu(10))}});
  const auto body = [&]() -> Process { timing = co_await chip.controller().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  EXPECT_EQ(timing.stages[0].cycles.count(), 80);
}

}  // namespace
}  // namespace leviosim::sim
