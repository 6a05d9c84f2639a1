// What must hold for the timing of small jobs on every chip, whatever its numbers: how jobs are put
// together, and what more work does. Better hardware is in hardware_properties_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "sim/work/op.h"
#include "tests/platform_models/timing_jobs.h"

namespace leviosim::platform::testing {
namespace {

class OnEveryChip : public ::testing::TestWithParam<std::string> {
 protected:
  const ChipConfig& chip() const {
    static std::map<std::string, ChipConfig> chips;
    const auto [found, is_new] = chips.try_emplace(GetParam());
    if (is_new) found->second = load_platform(GetParam());
    return found->second;
  }
  int workers() const { return chip().cluster.workers; }
  std::int64_t time(std::vector<work::Step> steps) const {
    return cycles(chip(), workers(), std::move(steps));
  }
  std::int64_t empty_fork() const { return time({team(workers(), {})}); }
  /// Everything that a job can have.
  Job mixed() const {
    std::vector<Segment> shares;
    for (int core = 0; core < workers(); ++core)
      shares.push_back(some_work(20 + 3 * static_cast<std::uint64_t>(core), 2));
    return job_of({serial(some_work(30)), transfer(5000, true), fork(shares), wait_for(0),
                   transfer(300), team(workers(), some_work(10, 3)), serial(some_work(5, 1))});
  }
};

INSTANTIATE_TEST_SUITE_P(Chips, OnEveryChip, ::testing::ValuesIn(platform_names()), name_of_test);

// ---- more work takes longer ----

TEST_P(OnEveryChip, MoreOfAnyOperationIsNeverFaster) {
  const std::int64_t before = time({serial(some_work(10))});
  for (const work::OpInfo& info : work::kOps) {
    Segment more = some_work(10);
    more[info.op] += 1000;
    EXPECT_GE(time({serial(more)}), before) << info.name;
  }
}

TEST_P(OnEveryChip, MoreOfAnyOperationOnOneCoreNeverEndsAForkEarlier) {
  std::vector<Segment> shares(static_cast<std::size_t>(workers()), plain_work(10));
  const std::int64_t before = time({fork(shares)});
  for (const work::OpInfo& info : work::kOps) {
    std::vector<Segment> more = shares;
    more[0][info.op] += 1000;
    EXPECT_GE(time({fork(more)}), before - 1) << info.name;
  }
}

/// But for what the model takes to be diluted: misses are spread over all fetches of a work
/// segment, near ones included.
TEST_P(OnEveryChip, MoreCodeOfAnyReuseIsHardlyEverFaster) {
  const std::int64_t before = time({serial(some_work(10))}) * 99 / 100;
  for (std::size_t k = 0; k < work::kReuseClasses; ++k) {
    Segment more = some_work(10);
    more.code[k] += 16000;
    EXPECT_GE(time({serial(more)}), before) << k;
  }
}

TEST_P(OnEveryChip, CodeThatIsReusedLaterIsNeverFaster) {
  std::int64_t before = 0;
  for (std::size_t k = 0; k < work::kReuseClasses; ++k) {
    Segment work = plain_work(10);
    work.code[k] = 16000;
    const std::int64_t now = time({serial(work)});
    EXPECT_GE(now, before) << k;
    before = now;
  }
}

TEST_P(OnEveryChip, MoreBytesAreNeverFaster) {
  std::int64_t before = 0;
  for (const std::int64_t bytes : {4, 64, 250, 256, 260, 1000, 4096, 60000}) {
    const std::int64_t now = time({transfer(bytes)});
    EXPECT_GE(now, before) << bytes;
    before = now;
  }
}

TEST_P(OnEveryChip, TwiceTheWorkTakesTwiceAsLong) {
  const std::int64_t once = time({serial(plain_work(1000))});
  EXPECT_NEAR(static_cast<double>(time({serial(plain_work(2000))})), static_cast<double>(2 * once),
              2);
}

TEST_P(OnEveryChip, TwiceTheWorkOfATeamTakesTwiceAsLong) {
  const auto forked = [&](std::uint64_t scale) {
    return static_cast<double>(time({team(workers(), plain_work(scale))}) - empty_fork());
  };
  EXPECT_NEAR(forked(2000), 2 * forked(1000), 4);
}

TEST_P(OnEveryChip, NoWorkTakesNoTime) {
  EXPECT_EQ(time({}), 0);
  EXPECT_EQ(time({serial({})}), 0);
}

// ---- parts add up ----

TEST_P(OnEveryChip, WorkInTwoPiecesTakesAsLong) {
  const std::int64_t whole = time({serial(plain_work(300))});
  const std::int64_t pieces = time({serial(plain_work(100)), serial(plain_work(200))});
  EXPECT_NEAR(static_cast<double>(whole), static_cast<double>(pieces), 1);
}

TEST_P(OnEveryChip, StagesAddUpToTheJob) {
  const Segment a = some_work(10), b = some_work(20, 1);
  const Job job{{{"a", {serial(a)}, {}}, {"b", {team(workers(), b)}, {}}}};
  EXPECT_EQ(cycles(chip(), workers(), job), time({serial(a)}) + time({team(workers(), b)}));
}

TEST_P(OnEveryChip, TheOrderOfStagesDoesNotMatter) {
  const work::StageRun a{"a", {serial(some_work(10))}, {}};
  const work::StageRun b{"b", {team(workers(), some_work(20, 1)), transfer(1000)}, {}};
  EXPECT_EQ(cycles(chip(), workers(), Job{{a, b}}), cycles(chip(), workers(), Job{{b, a}}));
}

TEST_P(OnEveryChip, AnEmptyStageChangesNothing) {
  Job job = mixed();
  const std::int64_t before = cycles(chip(), workers(), job);
  job.stages.insert(job.stages.begin(), {"nothing", {}, {}});
  EXPECT_EQ(cycles(chip(), workers(), job), before);
}

TEST_P(OnEveryChip, NamesDoNotMatter) {
  Job job = mixed();
  const std::int64_t before = cycles(chip(), workers(), job);
  job.stages[0].stage = "another name";
  EXPECT_EQ(cycles(chip(), workers(), job), before);
}

TEST_P(OnEveryChip, TheBreakdownAddsUp) {
  const sim::JobTiming timing = timing_of(chip(), workers(), mixed());
  for (const sim::StageTiming& stage : timing.stages)
    EXPECT_NEAR(stage.account.total(), static_cast<double>(workers() * stage.cycles.count()),
                1e-6 * stage.account.total() + 1e-3);
}

TEST_P(OnEveryChip, TheBreakdownHasNothingNegativeButRounding) {
  const sim::MechanismCycles b = timing_of(chip(), workers(), mixed()).stages[0].account.team;
  for (const sim::MechanismInfo& info : sim::kMechanisms)
    if (info.mechanism != sim::Mechanism::Rounding) {
      EXPECT_GE(b[info.mechanism], -1e-6) << info.key;
    }
}

TEST_P(OnEveryChip, TheBreakdownOfTheControllerAddsUp) {
  const sim::JobTiming timing = controlled(chip(), job_of({serial(some_work(50))}));
  for (const sim::StageTiming& stage : timing.stages)
    EXPECT_NEAR(stage.account.total(), static_cast<double>(stage.cycles.count()), 1e-3);
}

TEST_P(OnEveryChip, StepsFollowEachOtherWithoutGaps) {
  const sim::JobTiming timing = timing_of(chip(), workers(), mixed(), true);
  const sim::StageTiming& stage = timing.stages[0];
  ASSERT_EQ(stage.steps.size(), 7u);
  sim::Time end = stage.begin;
  for (const sim::StepTiming& step : stage.steps) {
    EXPECT_EQ(step.begin, end);
    end = step.end;
  }
  EXPECT_EQ(end, stage.end);
}

TEST_P(OnEveryChip, CoresWorkWithinTheirStep) {
  const sim::JobTiming timing = timing_of(chip(), workers(), mixed(), true);
  for (const sim::StepTiming& step : timing.stages[0].steps)
    for (const sim::CoreTiming& core : step.cores) {
      EXPECT_GE(core.begin, step.begin);
      EXPECT_LE(core.end, step.end);
    }
}

TEST_P(OnEveryChip, LookingOnChangesNothing) {
  EXPECT_EQ(sum_of_cycles(timing_of(chip(), workers(), mixed(), true)),
            sum_of_cycles(timing_of(chip(), workers(), mixed(), false)));
}

TEST_P(OnEveryChip, TheSameJobTakesTheSameTime) {
  EXPECT_EQ(cycles(chip(), workers(), mixed()), cycles(chip(), workers(), mixed()));
}

// ---- teams ----

TEST_P(OnEveryChip, NoTeamGainsMoreThanItsCores) {
  for (std::uint64_t flavour = 0; flavour < 6; ++flavour) {
    const auto n = static_cast<std::uint64_t>(workers());
    Segment all = some_work(100 * n, flavour);
    all.code[work::kNeverFetched] = 1600 * n;
    const std::int64_t one = cycles(chip(), 1, {fork({all})});
    const std::int64_t many = time({team(workers(), some_work(100, flavour))});
    EXPECT_LE(static_cast<double>(one) / static_cast<double>(many), workers() * 1.0001) << flavour;
  }
}

TEST_P(OnEveryChip, NoTeamOnCodeThatNoCacheHoldsGainsMoreThanItsCores) {
  for (std::size_t k = 0; k < work::kReuseDistances.size(); ++k) {
    const auto n = static_cast<std::uint64_t>(workers());
    const auto share = [&](std::uint64_t scale) {
      Segment work = only(Op::IntAlu, 1000 * scale);
      work.code[k] = 16 * 250 * scale;
      return work;
    };
    const std::int64_t one = cycles(chip(), 1, {fork({share(n)})});
    const std::int64_t many = time({team(workers(), share(1))});
    EXPECT_LE(static_cast<double>(one) / static_cast<double>(many), workers() * 1.0001) << k;
  }
}

TEST_P(OnEveryChip, ATeamIsNeverFasterThanOneOfItsCores) {
  for (std::uint64_t flavour = 0; flavour < 6; ++flavour) {
    const Segment share = some_work(100, flavour);
    EXPECT_GE(time({team(workers(), share)}), cycles(chip(), 1, {fork({share})})) << flavour;
  }
}

TEST_P(OnEveryChip, ALateCoreMakesTheOthersWait) {
  std::vector<Segment> shares(static_cast<std::size_t>(workers()), plain_work(10));
  shares.back() = plain_work(1000);
  EXPECT_GE(time({fork(shares)}), cycles(chip(), 1, {fork({plain_work(1000)})}));
}

TEST_P(OnEveryChip, UsefulWorkDoesNotDependOnTheTeam) {
  const auto useful = [&](int team_size, std::uint64_t scale) {
    return timing_of(chip(), team_size, job_of({team(team_size, plain_work(scale))}))
        .stages[0]
        .account.team.alone();
  };
  const auto n = static_cast<std::uint64_t>(workers());
  EXPECT_NEAR(useful(workers(), 100), useful(1, 100 * n), 1e-6 * useful(1, 100 * n));
}

TEST_P(OnEveryChip, OneCoreOfManyIsAChipWithOneCore) {
  const std::string& path = GetParam();
  const ChipConfig single = load_platform(path, {"cluster.workers=1"});
  const Job job = job_of({serial(some_work(20)), team(1, some_work(30, 1)), transfer(800)});
  EXPECT_EQ(cycles(single, 1, job), cycles(chip(), 1, job));
}

TEST_P(OnEveryChip, SharesOfManyCoresOnOneAreTheirSum) {
  const std::int64_t sum = cycles(chip(), 1, {fork({plain_work(600)})});
  const std::int64_t shares =
      cycles(chip(), 1, {fork({plain_work(100), plain_work(200), plain_work(300)})});
  EXPECT_EQ(sum, shares);
}

TEST_P(OnEveryChip, EveryForkCostsAsMuch) {
  const std::int64_t one = empty_fork();
  EXPECT_LE(time({team(workers(), {}), team(workers(), {})}), 2 * one);
  EXPECT_GT(time({team(workers(), {}), team(workers(), {})}), one);
}

TEST_P(OnEveryChip, AForkThatIsCutInTwoIsNeverFaster) {
  EXPECT_GE(time({team(workers(), plain_work(50)), team(workers(), plain_work(50))}),
            time({team(workers(), plain_work(100))}));
}

TEST_P(OnEveryChip, BalancedSharesAreNeverSlower) {
  if (workers() < 2) return;
  std::vector<Segment> uneven(static_cast<std::size_t>(workers()), plain_work(100));
  uneven[0] = plain_work(50);
  uneven[1] = plain_work(150);
  EXPECT_GE(time({fork(uneven)}), time({team(workers(), plain_work(100))}));
}

// ---- transfers ----

TEST_P(OnEveryChip, TwoTransfersTakeTwiceAsLong) {
  EXPECT_EQ(time({transfer(1000), transfer(1000)}), 2 * time({transfer(1000)}));
}

TEST_P(OnEveryChip, OneTransferIsFasterThanTwoHalves) {
  EXPECT_LE(time({transfer(2048)}), time({transfer(1024), transfer(1024)}));
}

TEST_P(OnEveryChip, ABackgroundTransferIsNeverSlower) {
  const std::int64_t waited = time({transfer(4000), serial(plain_work(50))});
  EXPECT_LE(time({transfer(4000, true), serial(plain_work(50)), wait_for(0)}), waited + 2);
}

TEST_P(OnEveryChip, ABackgroundTransferIsNotFree) {
  const std::int64_t work = time({serial(plain_work(50))});
  EXPECT_GE(time({transfer(4000, true), serial(plain_work(50)), wait_for(0)}), work);
  EXPECT_GE(time({transfer(4000, true), serial(plain_work(50)), wait_for(0)}),
            time({transfer(4000)}));
}

TEST_P(OnEveryChip, DirectionsOfTransfersTakeAsLong) {
  EXPECT_EQ(time({transfer(3000)}), time({transfer(3000, false, work::Direction::L1ToL2)}));
}

TEST_P(OnEveryChip, BothDirectionsAtOnceAreNoSlowerThanOneAfterTheOther) {
  const auto both = {transfer(8000, true), transfer(8000, true, work::Direction::L1ToL2),
                     wait_for(0), wait_for(1)};
  const auto same = {transfer(8000, true), transfer(8000, true), wait_for(0), wait_for(1)};
  EXPECT_LE(time(both), time(same));
}

// ---- units that are shared ----

TEST_P(OnEveryChip, BanksServeOneAccessPerCycle) {
  const Segment loads = only(Op::LoadStream, 5000);
  const std::int64_t took = time({team(workers(), loads)}) - empty_fork();
  EXPECT_GE(took * chip().cluster.l1.banks, 5000 * workers());
}

TEST_P(OnEveryChip, OneWordServesOneCoreAtATime) {
  if (chip().cluster.core[Op::LoadShared].unit != sim::Unit::Bank) return;
  const std::int64_t took = time({team(workers(), only(Op::LoadShared, 5000))}) - empty_fork();
  EXPECT_GE(took, 5000 * workers() - 1);
}

TEST_P(OnEveryChip, FloatingPointUnitsServeOneOperationPerCycle) {
  if (chip().cluster.fpu.units == 0) return;
  const std::int64_t took = time({team(workers(), only(Op::F32Add, 5000))}) - empty_fork();
  EXPECT_GE(took * chip().cluster.fpu.units, 5000 * workers());
}

TEST_P(OnEveryChip, DividersServeOneDivisionAtATime) {
  const sim::OpCost& division = chip().cluster.core[Op::F32Div];
  if (division.unit != sim::Unit::Divider) return;
  const std::int64_t took = time({team(workers(), only(Op::F32Div, 1000))}) - empty_fork();
  EXPECT_GE(static_cast<double>(took * chip().cluster.fpu.dividers),
            1000.0 * workers() * division.busy - 1);
}

/// But for its code, where no core has an instruction cache of its own.
TEST_P(OnEveryChip, WorkOnTheCoreAloneDoesNotWaitForOthers) {
  const Segment work = only(Op::IntAlu, 10'000);
  ChipConfig c = chip();
  if (c.cluster.icache.worker == Bytes(0)) c.cluster.icache.line = Bytes(0);
  EXPECT_EQ(cycles(c, workers(), {team(workers(), work)}) - empty_fork(),
            cycles(c, 1, {fork({work})}) - cycles(c, 1, {team(1, {})}));
}

TEST_P(OnEveryChip, IdleCoresDoNotDisturb) {
  std::vector<Segment> shares(static_cast<std::size_t>(workers()));
  shares[0] = plain_work(200);
  EXPECT_EQ(time({fork(shares)}) - empty_fork(),
            cycles(chip(), 1, {fork({plain_work(200)})}) - cycles(chip(), 1, {team(1, {})}));
}

}  // namespace
}  // namespace leviosim::platform::testing
