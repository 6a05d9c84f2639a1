// What must hold on every chip for the account of a job: what each operation and each core is
// booked for, and what does not depend on the team. How jobs are put together is in
// timing_properties_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/work/op.h"
#include "tests/platform_models/timing_jobs.h"
#include "tests/support/account_checks.h"

namespace leviosim::platform::testing {
namespace {

class Account : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { chip_ = load_platform(GetParam()); }
  int workers() const { return chip_.cluster.workers; }
  std::int64_t time(std::vector<work::Step> steps) const {
    return cycles(chip_, workers(), std::move(steps));
  }
  /// Each core has more to do than the one before.
  std::vector<Segment> uneven() const {
    std::vector<Segment> shares;
    for (int core = 0; core < workers(); ++core)
      shares.push_back(
          some_work(20 + 3 * static_cast<std::uint64_t>(core), static_cast<std::uint64_t>(core)));
    return shares;
  }

  ChipConfig chip_;
};

INSTANTIATE_TEST_SUITE_P(Chips, Account, ::testing::ValuesIn(platform_names()), name_of_test);

/// L2 answers on the clock of the controller.
TEST_P(Account, AnOperationAloneCostsItsPrice) {
  const sim::CoreConfig& core = chip_.cluster.core;
  const double l2_cycle = static_cast<double>(chip_.cluster.clock.count()) /
                          static_cast<double>(chip_.controller.clock.count());
  for (const work::OpInfo& info : work::kOps) {
    const sim::OpCost& cost = core[info.op];
    const bool is_of_l2 = info.op == Op::LoadL2 || info.op == Op::StoreL2;
    double price = cost.issue + cost.stall * (is_of_l2 ? l2_cycle : 1);
    if (info.op == Op::LoadStream || info.op == Op::LoadIndexed)
      price += core.load_use_fraction * core.load_use_stall;
    EXPECT_NEAR(static_cast<double>(time({serial(only(info.op, 10'000))})), 10'000 * price, 1)
        << info.name;
  }
}

TEST_P(Account, OperationsOfTheMasterAddUp) {
  std::int64_t sum = 0;
  Segment all;
  for (const work::OpInfo& info : work::kOps) {
    all[info.op] = 1000;
    sum += time({serial(only(info.op, 1000))});
  }
  EXPECT_NEAR(static_cast<double>(time({serial(all)})), static_cast<double>(sum),
              static_cast<double>(work::kOpCount));
}

TEST_P(Account, SerialWorkDoesNotDependOnTheTeam) {
  const Job job = job_of({serial(some_work(30, 1)), transfer(700), serial(some_work(5))});
  EXPECT_EQ(cycles(chip_, 1, job), cycles(chip_, workers(), job));
}

TEST_P(Account, TheTimeOfACoreIsItsWorkAndItsWaits) {
  const Job job = job_of({transfer(20'000, true), fork(uneven()), wait_for(0)});
  const sim::JobTiming timing = timing_of(chip_, workers(), job, true);
  const sim::StageTiming& stage = timing.stages[0];
  const double ticks = static_cast<double>((stage.end - stage.begin).count()) /
                       static_cast<double>(stage.cycles.count());
  for (const sim::StepTiming& step : stage.steps)
    for (const sim::CoreTiming& core : step.cores) {
      const double took = static_cast<double>((core.end - core.begin).count()) / ticks;
      EXPECT_NEAR(core.time.total(), took, 1);
    }
}

TEST_P(Account, EveryCoreCycleHasItsForkMechanismAndOperation) {
  const Job job = job_of({transfer(20'000, true), serial(some_work(7)), fork(uneven()), wait_for(0),
                          team(workers(), some_work(20, 1)), serial(some_work(5))});
  const sim::JobTiming on_team = timing_of(chip_, workers(), job, true);
  for (const sim::StageTiming& stage : on_team.stages) {
    EXPECT_GE(stage.account.forks.size(), 3u);
    EXPECT_NEAR(stage.account.total(), static_cast<double>(workers() * stage.cycles.count()),
                1e-9 * stage.account.total());
    sim::testing::expect_adds_up(stage.account, false);
  }
  for (const sim::StageTiming& stage : controlled(chip_, job).stages) {
    EXPECT_NEAR(stage.account.total(), static_cast<double>(stage.cycles.count()),
                1e-9 * stage.account.total());
    sim::testing::expect_adds_up(stage.account, true);
  }
}

TEST_P(Account, NoCoreIsFasterThanAlone) {
  const sim::JobTiming timing = timing_of(chip_, workers(), job_of({fork(uneven())}), true);
  for (const sim::CoreTiming& core : timing.stages[0].steps[0].cores) {
    EXPECT_GE(core.time.waiting(), -1e-6);
    EXPECT_GE(core.time[sim::Mechanism::Rounding], -1e-3);
  }
}

TEST_P(Account, WhichCoreDoesWhatDoesNotMatterIfPairsStay) {
  std::vector<Segment> shares = uneven();
  const std::int64_t before = time({fork(shares)});
  std::rotate(shares.begin(), shares.begin() + 1, shares.end());
  EXPECT_NEAR(static_cast<double>(time({fork(shares)})), static_cast<double>(before), 1);
}

TEST_P(Account, TheSameStageAgainTakesAsLong) {
  const work::StageRun stage{
      "stage", {serial(some_work(10)), team(workers(), some_work(20, 1)), transfer(1000)}, {}};
  const std::int64_t once = cycles(chip_, workers(), Job{{stage}});
  EXPECT_EQ(cycles(chip_, workers(), Job{{stage, stage, stage}}), 3 * once);
}

TEST_P(Account, AForkRightAfterAnotherIsNeverSlower) {
  const std::int64_t one = time({team(workers(), {})});
  const std::int64_t two = time({team(workers(), {}), team(workers(), {})});
  EXPECT_LE(two, 2 * one);
  const Segment little = only(Op::IntAlu, 1);
  EXPECT_GE(time({team(workers(), {}), serial(little), team(workers(), {})}), two);
}

TEST_P(Account, WaitingForWhatHasArrivedTakesTheWaitAlone) {
  const Segment work = only(Op::IntAlu, 100'000);
  const sim::DmaConfig& dma = chip_.cluster.dma;
  EXPECT_NEAR(
      static_cast<double>(time({transfer(64, true), serial(work), wait_for(0)})),
      static_cast<double>(time({serial(work)})) + dma.programming + dma.call + dma.completion, 2);
}

TEST_P(Account, MoreTransfersInTheBackgroundAreNeverFaster) {
  std::int64_t before = 0;
  for (int n = 1; n <= 12; ++n) {
    std::vector<work::Step> steps;
    for (int i = 0; i < n; ++i) steps.push_back(transfer(600, true));
    steps.push_back(serial(plain_work(20)));
    for (int i = 0; i < n; ++i) steps.push_back(wait_for(i));
    const std::int64_t now = time(std::move(steps));
    EXPECT_GE(now, before) << n;
    before = now;
  }
}

TEST_P(Account, WaitsAreNoneWhereNothingIsShared) {
  ChipConfig generous = chip_;
  const int cores = workers() + 1;
  generous.cluster.fpu = {cores, sim::FpuMapping::Fixed, cores, cores};
  generous.cluster.l1.banks = 1 << 20;
  generous.cluster.icache.line = Bytes(0);
  Segment work = plain_work(100);
  work[Op::LoadShared] = work[Op::StoreShared] = 0;
  const sim::MechanismCycles b =
      timing_of(generous, workers(), job_of({team(workers(), work)})).stages[0].account.team;
  EXPECT_LE(b.waiting(), 1e-3 * b.alone());
}

}  // namespace
}  // namespace leviosim::platform::testing
