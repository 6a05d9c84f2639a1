// The cluster's steps against closed formulas, and the breakdowns that must add up.
#include "sim/chip/cluster.h"

#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "sim/chip/chip.h"
#include "sim/work/op.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {
namespace {

using work::Counts;
using work::Op;

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
  EXPECT_EQ(t.stages[0].account.team[Mechanism::Serial], 8 * 1234);
}

/// When the last of two jobs of 1000 cycles ends, one on the cluster and one on the controller.
std::int64_t cycles_of_both(bool one_core) {
  ChipConfig config = test_chip();
  config.cluster.events.offload = 0;
  config.controller.shares_core = one_core;
  Chip chip(config, 1);
  const work::Job job = one_stage({work::Serial{alu(1000)}});
  Time end;
  const auto offload = [&]() -> Process { end = (co_await chip.offload(job)).end; };
  const auto control = [&]() -> Process { end = (co_await chip.control(job)).end; };
  chip.kernel().spawn("offload", offload());
  chip.kernel().spawn("control", control());
  EXPECT_EQ(chip.kernel().run(), 0U);
  return chip.controller().clock().whole_cycles(end - Time{}).count();
}

TEST(Chip, ClusterAndControllerTakeTurnsOnAnOnlyCore) {
  EXPECT_EQ(cycles_of_both(false), 1000);
  EXPECT_EQ(cycles_of_both(true), 2000);
}

TEST(Cluster, AForkRightAfterAnotherTakesLess) {
  ChipConfig config = test_chip();
  config.cluster.events.fork_again = 0.5;
  const work::Fork empty{"empty", std::vector<work::Segment>(8), false};
  const auto cycles = [&](std::vector<work::Step> steps) {
    return run(one_stage(std::move(steps)), 8, config).stages[0].cycles.count();
  };
  EXPECT_EQ(cycles({empty}), kForkCost);
  EXPECT_EQ(cycles({empty, empty, empty}), kForkCost + 2 * (20 + 10 + 10));
  EXPECT_EQ(cycles({empty, work::Serial{alu(7)}, empty}), 2 * kForkCost + 7);
  const JobTiming timing = run(one_stage({empty, empty}), 8, config);
  EXPECT_EQ(timing.stages[0].account.team[Mechanism::Synchronisation], 8 * (kForkCost + 40));
}

TEST(Cluster, TransferOfNBytes) {
  for (const std::int64_t bytes : {1, 8, 9, 19'200, 65'536}) {
    const JobTiming t = run(one_stage({work::Transfer{work::Direction::L2ToL1, Bytes(bytes)}}));
    EXPECT_EQ(t.stages[0].cycles.count(), 25 + 16 + (bytes + 7) / 8 + 8) << bytes;
  }
}

TEST(Cluster, AShortTransferTakesAsLongAsTheCallOfTheApi) {
  ChipConfig config = test_chip();
  config.cluster.dma.call = 40;
  const auto cycles = [&](std::int64_t bytes) {
    const work::Transfer transfer{work::Direction::L2ToL1, Bytes(bytes)};
    const std::int64_t n = run(one_stage({transfer}), 8, config).stages[0].cycles.count();
    EXPECT_EQ(n, transfer_cycles(config.cluster.dma, Bytes(bytes))) << bytes;
    return n;
  };
  EXPECT_EQ(cycles(8), 25 + 40 + 8);
  EXPECT_EQ(cycles(192), 25 + 40 + 8);
  EXPECT_EQ(cycles(200), 25 + 16 + 25 + 8);
}

TEST(Cluster, BackgroundTransfersOverlapWithWorkAndWithTheOtherDirection) {
  const work::Transfer in{work::Direction::L2ToL1, Bytes(8000), true};
  const work::Transfer out{work::Direction::L1ToL2, Bytes(8000), true};
  const auto cycles = [](std::vector<work::Step> steps) {
    return run(one_stage(std::move(steps))).stages[0].cycles.count();
  };
  const work::TransferWait first{0};
  const work::TransferWait second{1};
  constexpr std::int64_t kAlone = 25 + 16 + 1000 + 8;
  EXPECT_EQ(cycles({in, first}), kAlone) << "as a blocking one";
  EXPECT_EQ(cycles({in, work::Serial{alu(500)}, first}), kAlone) << "hidden work";
  EXPECT_EQ(cycles({in, work::Serial{alu(5000)}, first}), 25 + 5000 + 8) << "hidden transfer";
  EXPECT_EQ(cycles({in, out, first, second}), 25 + kAlone) << "both directions at once";
  EXPECT_EQ(cycles({in, in, first, second}), kAlone + 1000) << "one behind the other";
}

TEST(Cluster, AFullQueueOfTheDmaLetsTheProgrammingCoreWait) {
  const work::Transfer in{work::Direction::L2ToL1, Bytes(8000), true};
  const auto cycles_with = [&](int commands) {
    ChipConfig config = test_chip();
    config.cluster.dma.commands = commands;
    // The work lasts longer than any transfer, so only programming can let it wait.
    return run(one_stage({in, in, in, work::Serial{alu(10'000)}, work::TransferWait{2}}), 8, config)
        .stages[0]
        .cycles.count();
  };
  constexpr std::int64_t kWork = 10'000 + 8;
  EXPECT_EQ(cycles_with(0), 3 * 25 + kWork) << "any number may be under way";
  EXPECT_EQ(cycles_with(3), 3 * 25 + kWork);
  constexpr std::int64_t kFirst = 25 + 16 + 1000;  // has arrived
  EXPECT_EQ(cycles_with(2), kFirst + 25 + kWork) << "the third finds room when the first is there";
  EXPECT_EQ(cycles_with(1), kFirst + (25 + 16 + 1000) + 25 + kWork) << "one after the other";
}

TEST(Cluster, TheDmaTakesBanksFromTheCores) {
  Counts work;
  work[Op::LoadStream] = 10'000;
  const work::Transfer in{work::Direction::L2ToL1, Bytes(1'000'000), true};
  work::Fork fork{"fork", std::vector<work::Segment>(8, work)};
  const JobTiming t = run(one_stage({in, fork, work::TransferWait{0}}));
  // Two words per cycle on 16 banks: an access waits 2/(2·16) cycles.
  EXPECT_NEAR(t.stages[0].account.team[Mechanism::Banks], 8 * 10'000 * 2.0 / 32, 8 * 3);
}

TEST(Cluster, AMasterThatTakesPartIsOneMoreCore) {
  work::Fork fork{"fork", std::vector<work::Segment>(9, alu(100)), true};
  fork.shares.back() = alu(1000);
  const JobTiming t = run(one_stage({fork}));
  EXPECT_EQ(t.stages[0].cycles.count(), 40 + 1000 + 10) << "the master needs no wake-up";
  EXPECT_EQ(t.stages[0].account.team.alone(), 800) << "of the workers";
  EXPECT_NEAR(t.stages[0].account.total(), 8 * 1050, 1e-6);
}

TEST(Cluster, ABarrierReleasesOnTheLastArrival) {
  work::Fork fork{"fork", {}};
  for (std::uint64_t k = 1; k <= 8; ++k) fork.shares.push_back(alu(100 * k));
  const JobTiming t = run(one_stage({fork}));
  EXPECT_EQ(t.stages[0].cycles.count(), 800 + kForkCost);
  EXPECT_EQ(t.stages[0].account.team[Mechanism::Imbalance],
            100 + 200 + 300 + 400 + 500 + 600 + 700);
  EXPECT_EQ(t.stages[0].account.team.alone(), 3600);
}

TEST(Cluster, OneWorkerRunsAllSharesOfEight) {
  work::Fork fork{"fork", std::vector<work::Segment>(8, alu(100))};
  EXPECT_EQ(run(one_stage({fork}), 1).stages[0].cycles.count(), 800 + kForkCost);
  EXPECT_EQ(run(one_stage({fork}), 3).stages[0].cycles.count(), 300 + kForkCost);
}

/// No forks and no waiting for the slowest: the program of one core.
TEST(Cluster, AMasterAloneRunsAllSharesOneAfterTheOther) {
  const work::Fork fork{"fork", {alu(100), alu(300), alu(50)}, false};
  const JobTiming t =
      run(one_stage({work::Serial{alu(7)}, fork, work::Serial{alu(5)}}), Cluster::kMasterAlone);
  EXPECT_EQ(t.stages[0].cycles.count(), 7 + 450 + 5);
  EXPECT_EQ(t.stages[0].account.team[Mechanism::Serial], 12);
  EXPECT_EQ(t.stages[0].account.team[Mechanism::Issue], 450);
  EXPECT_EQ(t.stages[0].account.total(), 462);
}

/// Its scratch begins where that of the first of a team does.
TEST(Cluster, WordsOfAMasterAloneStraddleAsInTheFirstShare) {
  ChipConfig config = test_chip();
  config.cluster.core.ops[work::index(Op::Straddle)] = {0, 1, Unit::Core};
  const auto share = [](std::uint64_t loads, std::uint64_t straddling) {
    Counts counts;
    counts[Op::LoadStream] = loads;
    counts[Op::Straddle] = straddling;
    return work::Segment{counts};
  };
  for (const std::uint64_t first : {0, 25}) {
    const work::Fork fork{"fork", {share(100, first), share(300, 200)}, false};
    const JobTiming t = run(one_stage({fork}), Cluster::kMasterAlone, config);
    EXPECT_EQ(t.stages[0].cycles.count(), 400 + 4 * static_cast<std::int64_t>(first));
    work::Fork aligned = fork;
    aligned.aligned_on_one_core = true;
    const JobTiming of_aligned = run(one_stage({aligned}), Cluster::kMasterAlone, config);
    EXPECT_EQ(of_aligned.stages[0].cycles.count(), 400);
    EXPECT_EQ(run(one_stage({aligned}), 2, config).stages[0].cycles,
              run(one_stage({fork}), 2, config).stages[0].cycles);
  }
}

TEST(Cluster, TheBreakdownOfAStageAddsUpToItsCoreCycles) {
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
      counts[Op::LoadIndexed] = random(500);
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
  EXPECT_GT(stage.account.team[Mechanism::Fpu], 0);
  EXPECT_GT(stage.account.team[Mechanism::Divider], 0);
  EXPECT_GT(stage.account.team[Mechanism::Banks], 0);
  EXPECT_GE(stage.account.team[Mechanism::Rounding], 0);
  EXPECT_LT(stage.account.team[Mechanism::Rounding], 8 * 40);
}

TEST(Cluster, EveryTeamSizeUpToTheEventUnitsLimit) {
  EXPECT_THROW(run(one_stage({work::Serial{alu(1)}}), 9), InputError);
  EXPECT_THROW(run(one_stage({work::Serial{alu(1)}}), 0), InputError);
}

TEST(Chip, L2AnswersOnTheClockOfTheSoc) {
  ChipConfig config = test_chip();
  config.cluster.core.ops[work::index(Op::LoadL2)] = {1, 12, Unit::Core};
  config.controller.clock = Hertz(185'000'000);  // half the cluster's
  Counts loads;
  loads[Op::LoadL2] = 100;
  const auto cycles = [&](work::Step step) {
    Chip chip(config, 8);
    JobTiming timing;
    const work::Job job = one_stage({step});
    const auto body = [&]() -> Process { timing = co_await chip.cluster().run(job); };
    chip.kernel().spawn("test", body());
    chip.kernel().run();
    return timing.stages[0].cycles.count();
  };
  EXPECT_EQ(cycles(work::Serial{loads}), 100 * (1 + 2 * 12));
  EXPECT_EQ(cycles(work::Transfer{work::Direction::L2ToL1, Bytes(800)}), 25 + 2 * 16 + 200 + 8);
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
  const work::Job job = one_stage({work::Fork{"f", std::vector<work::Segment>(8, alu(10))}});
  const auto body = [&]() -> Process { timing = co_await chip.controller().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  EXPECT_EQ(timing.stages[0].cycles.count(), 80);
}

}  // namespace
}  // namespace leviosim::sim
