// Cores that share units, against closed formulas and the vendor's calibration table
// (FACTS.md#calibration-table).
#include "sim/chip/team.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/work/op.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {
namespace {

using work::Counts;
using work::Op;

Counts counts(std::initializer_list<std::pair<Op, std::uint64_t>> list) {
  Counts c;
  for (const auto& [op, n] : list) c[op] += n;
  return c;
}

struct Outcome {
  std::vector<std::int64_t> cycles;
  std::vector<MechanismCycles> time;
};

/// Runs work[i] on core i, all starting at cycle start[i], and returns how long each took.
Outcome run_together(const std::vector<Counts>& work, ClusterConfig config = test_cluster(),
                     std::vector<std::int64_t> start = {}) {
  start.resize(work.size(), 0);
  const std::vector<work::Segment> segments(work.begin(), work.end());
  std::vector<TeamShare> shares;
  for (std::size_t i = 0; i < work.size(); ++i)
    shares.push_back({static_cast<int>(i), &segments[i], Cycles(start[i])});
  Team(config, static_cast<int>(work.size())).execute(shares, Traffic(0));
  Outcome out;
  for (const TeamShare& share : shares) {
    out.cycles.push_back((share.end - share.begin).count());
    out.time.push_back(share.time);
  }
  return out;
}

constexpr std::uint64_t kN = 10'000;

/// Cycles per slot when `cores` cores run the same stream at the same time; the longest of them.
double per_slot(int cores, const Counts& stream, double slots) {
  ClusterConfig config = test_cluster();
  config.l1.banks = 1 << 20;  // the streams access no memory
  const Outcome o =
      run_together(std::vector<Counts>(static_cast<std::size_t>(cores), stream), config);
  return static_cast<double>(*std::max_element(o.cycles.begin(), o.cycles.end())) / slots;
}

TEST(Team, OneCoreAloneTakesItsLoneTime) {
  const Outcome o = run_together({counts({{Op::IntAlu, 100}, {Op::F32Fma, 50}, {Op::F32Div, 3}})});
  EXPECT_EQ(o.cycles[0], 100 + 50 + 3 * 14);
  EXPECT_EQ(o.time[0][Mechanism::Fpu], 0);
  EXPECT_EQ(o.time[0][Mechanism::Divider], 0);
  EXPECT_EQ(o.time[0][Mechanism::Rounding], 0);
}

TEST(Team, NoWorkTakesNoTime) { EXPECT_EQ(run_together({Counts{}}).cycles[0], 0); }

TEST(Team, TwoCoresOnOneFpuTakeTurns) {
  const Counts stream = counts({{Op::F32Add, kN}});
  std::vector<Counts> work(5);
  work[0] = work[4] = stream;  // unit 0 serves cores 0 and 4
  const Outcome same = run_together(work);
  EXPECT_EQ(same.cycles[0], 2 * static_cast<std::int64_t>(kN));
  EXPECT_EQ(same.cycles[4], 2 * static_cast<std::int64_t>(kN));
  EXPECT_DOUBLE_EQ(same.time[0][Mechanism::Fpu], static_cast<double>(kN));
  work[4] = Counts{};
  work[1] = stream;  // unit 1
  const Outcome apart = run_together(work);
  EXPECT_EQ(apart.cycles[0], static_cast<std::int64_t>(kN));
  EXPECT_EQ(apart.cycles[1], static_cast<std::int64_t>(kN));
}

TEST(Team, ALateStarterSlowsOnlyWhatIsLeft) {
  std::vector<Counts> work(5);
  work[0] = counts({{Op::F32Add, 1000}});
  work[4] = counts({{Op::F32Add, 1000}});
  const Outcome o = run_together(work, test_cluster(), {0, 0, 0, 0, 400});
  // Core 0: 400 alone, then 600 at half speed. Core 4: 600 done when core 0 ends, 400 alone.
  EXPECT_EQ(o.cycles[0], 400 + 2 * 600);
  EXPECT_EQ(o.cycles[4], 2 * 600 + 400);
}

// 1001 operations of 1.3 cycles each for two cores end between two edges of the clock. What is left
// to the next edge is rounding, and nobody waited for a unit meanwhile.
TEST(Team, TheEndOfAShareIsRoundedNotWaitedFor) {
  ClusterConfig config = test_cluster();
  config.core.ops[work::index(Op::F32Add)].busy = 1.3;
  std::vector<Counts> work(5);
  work[0] = work[4] = counts({{Op::F32Add, 1001}});
  const Outcome o = run_together(work, config);
  EXPECT_EQ(o.cycles[0], 2603);
  EXPECT_NEAR(o.time[0][Mechanism::Fpu], 2602.6 - 1001, 1e-6);
  EXPECT_NEAR(o.time[0][Mechanism::Rounding], 0.4, 1e-6);
}

TEST(Team, DynamicMappingUsesAnyFreeUnit) {
  ClusterConfig config = test_cluster();
  config.fpu.mapping = FpuMapping::Dynamic;
  std::vector<Counts> work(5);
  work[0] = work[4] = counts({{Op::F32Add, 1000}});
  EXPECT_EQ(run_together(work, config).cycles[0], 1000);
}

struct CalibrationRow {
  const char* name;
  Op op;
  std::uint64_t nops;  ///< between two operations
  double expected[4];  ///< cycles per slot on 1, 5, 8, 9 cores
};

TEST(Team, VendorCalibrationTableWithinFivePercent) {
  const CalibrationRow rows[] = {
      {"add stream", Op::F32Add, 0, {1.02, 2.02, 2.02, 3.02}},
      {"add and nop", Op::F32Add, 1, {1.02, 1.02, 1.03, 1.52}},
      {"fdiv.s", Op::F32Div, 0, {14.02, 70.05, 112.09, 126.10}},
      {"fsqrt.s", Op::F32Sqrt, 0, {14.02, 70.05, 112.09, 126.10}},
      {"fdiv.s and nop", Op::F32Div, 1, {7.5, 35.3, 56.1, 63.1}},
      {"vfmac.h stream", Op::F16Op, 0, {1.02, 2.02, 2.02, 3.02}},
      {"int64 stream", Op::Int64Mac, 0, {1.02, 2.02, 2.02, 3.02}},
      {"fdiv.h", Op::F16Div, 0, {10.02, 50.05, 80.10, 90.10}},
  };
  const int cores[] = {1, 5, 8, 9};
  for (const CalibrationRow& row : rows)
    for (int i = 0; i < 4; ++i) {
      const Counts stream = counts({{row.op, kN}, {Op::IntAlu, row.nops * kN}});
      const double slots = static_cast<double>(kN * (1 + row.nops));
      EXPECT_NEAR(per_slot(cores[i], stream, slots), row.expected[i], 0.05 * row.expected[i])
          << row.name << " on " << cores[i] << " cores";
    }
}

TEST(Team, TheDividerIsIndependentOfTheFpus) {
  std::vector<Counts> work(8, counts({{Op::F32Add, 28 * kN}}));
  work[0] = counts({{Op::F32Div, kN}});
  const Outcome o = run_together(work);
  EXPECT_NEAR(static_cast<double>(o.cycles[0]) / kN, 14.11, 0.05 * 14.11);
}

/// Cycles per operation of eight cores, the first `some` of which run a stream of `a`, the others
/// one of `b`.
double mixed(std::size_t some, Op a, Op b) {
  std::vector<Counts> work(8, counts({{b, kN}}));
  for (std::size_t i = 0; i < some; ++i) work[i] = counts({{a, kN}});
  const Outcome o = run_together(work);
  return static_cast<double>(*std::max_element(o.cycles.begin(), o.cycles.end())) / kN;
}

TEST(Team, DivisionsOfDifferentLengthTakeTurns) {
  EXPECT_NEAR(mixed(4, Op::F32Div, Op::F16Div), 96.09, 0.05 * 96.09);
  EXPECT_NEAR(mixed(2, Op::F32Div, Op::F16Div), 88.09, 0.05 * 88.09);
}

TEST(Team, TheInt64UnitsAreIndependentOfTheFpus) {
  EXPECT_NEAR(mixed(4, Op::Int64Add, Op::F32Add), 1.04, 0.05 * 1.04);
}

TEST(Team, BankConflictsDelayEachAccessByTheOthersDemand) {
  // Eight cores, each cycle an access: an access waits 7·r/(2·16), r the accesses per cycle.
  const Outcome o = run_together(std::vector<Counts>(8, counts({{Op::LoadIndexed, kN}})));
  const double r = (-1 + std::sqrt(1 + 4 * 7.0 / 32)) / (2 * 7.0 / 32);  // r = 1/(1 + 7 r/32)
  EXPECT_NEAR(static_cast<double>(o.cycles[0]), kN / r, 2);
  EXPECT_NEAR(o.time[0][Mechanism::Banks], kN / r - kN, 2);
}

TEST(Team, StreamsGetOutOfEachOthersWay) {
  const Outcome o = run_together(std::vector<Counts>(8, counts({{Op::LoadStream, kN}})));
  for (const std::int64_t cycles : o.cycles) EXPECT_EQ(cycles, static_cast<std::int64_t>(kN));
  std::vector<Counts> mixed(8, counts({{Op::LoadStream, kN}}));
  mixed[0] = counts({{Op::LoadIndexed, kN}});
  EXPECT_GT(run_together(mixed).cycles[1], static_cast<std::int64_t>(kN)) << "but not of others'";
}

TEST(Team, StreamsTakeNoMoreThanTheBanksServe) {
  ClusterConfig config = test_cluster();
  config.l1.banks = 2;
  const Outcome o = run_together(std::vector<Counts>(8, counts({{Op::LoadStream, kN}})), config);
  for (const std::int64_t cycles : o.cycles) EXPECT_NEAR(static_cast<double>(cycles), 4.0 * kN, 2);
  EXPECT_NEAR(o.time[0][Mechanism::Banks], 3.0 * kN, 2);
  // Two cores that load every other cycle leave each other alone.
  const Counts light = counts({{Op::LoadStream, kN}, {Op::IntAlu, kN}});
  EXPECT_EQ(run_together({light, light}, config).cycles[0], static_cast<std::int64_t>(2 * kN));
}

TEST(Team, CoresOnOneWordTakeTurns) {
  const Outcome o = run_together(std::vector<Counts>(8, counts({{Op::LoadShared, kN}})));
  EXPECT_NEAR(static_cast<double>(o.cycles[0]), 8.0 * kN, 2);
  EXPECT_NEAR(o.time[0][Mechanism::Banks], 7.0 * kN, 2);
}

/// Cycles per line that the cores wait for code of which each byte is `farther` than their caches.
MechanismCycles fetching(int cores, std::size_t reuse_class) {
  ClusterConfig config = test_cluster();
  config.icache = {Bytes(16), Bytes(512), Bytes(2048), Bytes(4096), 2, 2.0, 20.0, 1.0};
  Counts work = counts({{Op::IntAlu, 10 * kN}});
  work.code[reuse_class] = 16 * kN;  // a line every 10 instructions
  return run_together(std::vector<Counts>(static_cast<std::size_t>(cores), work), config).time[0];
}

TEST(Team, CodeThatTheSharedCacheHoldsCostsEachCoreItsPrivateMisses) {
  const std::size_t class_of_2k = work::reuse_class(2048);
  const MechanismCycles alone = fetching(1, class_of_2k);
  // One line in a hundred misses there, too, as lines collide by chance.
  EXPECT_NEAR(alone[Mechanism::Fetch], 2.0 * kN, 0.2 * kN);
  EXPECT_EQ(alone[Mechanism::FetchContention], 0);
  // Seven others with a line per 12 cycles on two banks: 7/12/(2·2) cycles a line, or a little
  // less.
  const MechanismCycles together = fetching(8, class_of_2k);
  EXPECT_NEAR(together[Mechanism::FetchContention], 7.0 / 12 / 4 * kN, 0.02 * kN);
}

TEST(Team, WithoutPrivateCachesTheSharedOneDeliversEachLine) {
  ClusterConfig config = test_cluster();
  config.icache = {Bytes(16), Bytes(0), Bytes(0), Bytes(16384), 8, 0.0, 13.0, 2.0};
  const std::vector<Counts> work(8, counts({{Op::IntAlu, kN}}));
  // A line for four instructions: r = 1 / (1 + 7 r / 4 / 4 / (2 * 8)).
  const double k = 7.0 / 16 / 16;
  const double rate = (-1 + std::sqrt(1 + 4 * k)) / (2 * k);
  EXPECT_NEAR(run_together(work, config).time[0][Mechanism::FetchContention], kN / rate - kN, 2);
  EXPECT_EQ(run_together({work[0]}, config).cycles[0], static_cast<std::int64_t>(kN));
  config.icache.worker = Bytes(512);
  EXPECT_EQ(run_together(work, config).time[0][Mechanism::FetchContention], 0);
}

TEST(Team, RefillsFromL2AreServedInTurn) {
  EXPECT_NEAR(fetching(1, work::kNeverFetched)[Mechanism::Fetch], 20.0 * kN, 1);
  // All of a team wait for each line as one alone would, and it is fetched for all: the refills of
  // eight cores keep L2 as busy as those of one.
  const MechanismCycles all = fetching(8, work::kNeverFetched);
  EXPECT_NEAR(all[Mechanism::Fetch], 20.0 * kN, 1);
  EXPECT_LT(all[Mechanism::FetchContention], 0.2 * all[Mechanism::Fetch]);
}

TEST(Team, MixedDemandsNeverExceedAUnitAndLeaveNoneIdleNeedlessly) {
  // Cores 0 and 4 share a unit with demands 0.9 and 0.3: together 1.2 of 1. The small one gets all
  // it asks for, the large one the rest.
  std::vector<Counts> work(5);
  work[0] = counts({{Op::F32Add, 9 * kN}, {Op::IntAlu, kN}});
  work[4] = counts({{Op::F32Add, 30 * kN}, {Op::IntAlu, 70 * kN}});
  const Outcome o = run_together(work);
  EXPECT_NEAR(static_cast<double>(o.cycles[0]), 10.0 * kN * 0.9 / 0.7, 2);
  EXPECT_EQ(o.cycles[4], static_cast<std::int64_t>(100 * kN));
}

}  // namespace
}  // namespace leviosim::sim
