// Instruction caches that are stepped line by line (tests/support/line_caches.h): what they say
// about teams, and the model of sim/chip/instruction_cache.h against them on loops over functions.
#include "tests/support/line_caches.h"
#include "sim/work/op.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/chip/chip.h"
#include "sim/work/code_tracker.h"
#include "tests/sim/chip_test_config.h"
#include "tests/support/code_lines.h"

namespace leviosim::sim {
namespace {

using tests::LineCaches;
using tests::LineList;
using tests::SteppedCaches;
using tests::Walker;

constexpr double kWork = 5;  ///< cycles of work on a line: some four instructions

InstructionCacheConfig stepped_caches() {
  InstructionCacheConfig c;
  c.line = Bytes(16);
  c.worker = Bytes(512);
  c.master = Bytes(2048);
  c.shared = Bytes(4096);
  c.shared_banks = 2;
  c.shared_hit = 2;
  c.shared_miss = 20;
  c.refills = 2;
  return c;
}

LineList straight(std::uint32_t lines) {
  LineList list(lines);
  std::iota(list.begin(), list.end(), 0U);
  return list;
}

LineList rounds_of(const LineList& loop, int rounds) {
  LineList all;
  for (int i = 0; i < rounds; ++i) all.insert(all.end(), loop.begin(), loop.end());
  return all;
}

SteppedCaches stepped(const LineList& lines, std::size_t cores, double work = kWork) {
  return LineCaches(stepped_caches(), stepped_caches().worker, 1)
      .run(std::vector<Walker>(cores, {&lines, work, 0}));
}

TEST(LineCaches, LoopsThatFitAreFetchedOnce) {
  const LineList loop = rounds_of(straight(32), 10);
  const SteppedCaches once = stepped(loop, 1);
  EXPECT_EQ(once.refills, 32U);
  EXPECT_EQ(once.cores[0].requests, 32U);
  EXPECT_DOUBLE_EQ(once.cores[0].stall, 32 * 20.0);
  EXPECT_DOUBLE_EQ(once.cores[0].end, 320 * kWork + 32 * 20.0);
}

TEST(LineCaches, WhatTheSharedCacheHoldsCostsTwoCyclesALine) {
  const SteppedCaches few = stepped(rounds_of(straight(200), 10), 1);
  EXPECT_EQ(few.refills, 200U);
  const double hits = static_cast<double>(few.cores[0].requests) - 200;
  EXPECT_DOUBLE_EQ(few.cores[0].stall, 200 * 20 + 2 * hits);
}

/// Each of eight cores on cold straight-line code takes about as long as one alone.
TEST(LineCaches, ATeamThatStartsColdWaitsForTheSameLines) {
  const LineList code = straight(128);  // 2 kB
  const SteppedCaches one = stepped(code, 1);
  const SteppedCaches all = stepped(code, 8);
  EXPECT_EQ(all.refills, 128U);
  EXPECT_GT(all.last_end(), 0.98 * one.last_end());
  EXPECT_LT(all.last_end(), 1.1 * one.last_end());
}

/// A loop that the shared cache does not hold, with an eighth of the rounds for each of eight
/// cores: 6.54 times as fast was measured (4.5 kB), and it cannot be more than 8.
TEST(LineCaches, ATeamGainsLessThanItsCores) {
  const LineList loop = straight(288);
  const double one = stepped(rounds_of(loop, 400), 1).last_end();
  const double all = stepped(rounds_of(loop, 50), 8).last_end();
  EXPECT_LT(one / all, 8);
  EXPECT_GT(one / all, 6);
}

/// A loop over functions of 28 lines, which lie in memory between others by chance.
class Loop {
 public:
  explicit Loop(std::uint32_t bytes) {
    for (std::uint32_t left = bytes; left > 0;) {
      const std::uint32_t size = std::min(left, 28U * 16);
      names_.push_back("function " + std::to_string(names_.size()));
      map_.add(names_.back(), "", size);
      for (std::uint32_t i = 0; i < 4; ++i)
        map_.add("another " + std::to_string(4 * names_.size() + i), "",
                 16 * (1 + 37 * (4 * static_cast<std::uint32_t>(names_.size()) + i) % 80));
      left -= size;
    }
  }
  /// @param core  begins at a place of its own
  template <class Enter>
  void go_round(int rounds, const Enter& enter) const {
    for (int round = 0; round < rounds; ++round)
      for (const std::string& name : names_) enter(work::CodeName(name));
  }
  LineList lines(int rounds, std::uint64_t layout) const {
    const tests::CodeLayout place(map_, layout);
    tests::CodeWalk walk(place);
    std::vector<work::CodeEvent> events;
    go_round(rounds, [&](work::CodeName name) {
      events.push_back(name.key);
      events.push_back(work::CodeEvents::kLeave);
    });
    walk.follow(events);
    return walk.lines();
  }
  work::CodeReuse reuse(int rounds) const {
    work::CodeTracker tracker(map_);
    work::take_tally();
    work::current_code = &tracker;
    go_round(rounds, [](work::CodeName name) {
      work::code_events.enter(name);
      work::code_events.leave();
    });
    work::fetch_code();
    work::current_code = nullptr;
    return work::take_tally().code;
  }

 private:
  work::CodeMap map_;
  std::vector<std::string> names_;
};

constexpr int kRounds = 60;
constexpr int kLayouts = 40;

double stepped_stall(const Loop& loop, std::size_t cores, bool in_step) {
  double sum = 0;
  for (std::uint64_t layout = 1; layout <= kLayouts; ++layout) {
    const LineList lines = loop.lines(kRounds, layout);
    tests::RandomNumbers random(layout);
    std::vector<Walker> walkers;
    for (std::size_t core = 0; core < cores; ++core)
      walkers.push_back(
          {&lines, kWork,
           in_step ? 0 : random.below(static_cast<std::uint32_t>(lines.size() / kRounds))});
    sum += LineCaches(stepped_caches(), stepped_caches().worker, layout).run(walkers).mean_stall();
  }
  return sum / kLayouts;
}

double modelled_stall(const Loop& loop, int cores) {
  work::Counts counts;
  counts.code = loop.reuse(kRounds);
  std::uint64_t bytes = 0;
  for (const std::uint64_t n : counts.code) bytes += n;
  counts[work::Op::IntAlu] = static_cast<std::uint64_t>(kWork * static_cast<double>(bytes) / 16);
  ChipConfig config = test_chip();
  config.cluster.icache = stepped_caches();
  Chip chip(config, cores);
  JobTiming timing;
  const work::Job job{
      {{"loop", {work::Fork{"loop", std::vector<work::Segment>(cores, {counts, {}}), false}}, {}}}};
  const auto body = [&]() -> Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  const MechanismCycles& b = timing.stages[0].account.team;
  return (b[Mechanism::Fetch] + b[Mechanism::FetchContention]) / cores;
}

/// Near the capacity few functions decide how many lines fall on a set, and the model's mean over
/// all numbers of functions is up to a third off. Below it, teams wait less for banks than at
/// random.
double tolerance(std::uint32_t bytes) { return bytes > 3000 && bytes < 6000 ? 0.35 : 0.12; }

TEST(InstructionCacheModel, AgreesWithSteppedCachesOnLoopsOfFunctions) {
  for (const std::uint32_t bytes :
       {384U, 768U, 1536U, 3072U, 4096U, 4608U, 5120U, 6144U, 8192U, 16384U}) {
    const Loop loop(bytes);
    for (const std::size_t cores : {1U, 8U}) {
      const double expected = stepped_stall(loop, cores, true);
      const double model = modelled_stall(loop, static_cast<int>(cores));
      EXPECT_NEAR(model, expected, tolerance(bytes) * expected + 100)
          << bytes << " B, " << cores << " cores: " << model / expected - 1;
    }
  }
}

/// Larger than the shared cache: cores at places by chance catch up with each other.
TEST(InstructionCacheModel, AgreesWithSteppedCachesOnTeamsOutOfStep) {
  for (const std::uint32_t bytes : {6144U, 8192U, 16384U}) {
    const Loop loop(bytes);
    const double expected = stepped_stall(loop, 8, false);
    EXPECT_NEAR(modelled_stall(loop, 8), expected, tolerance(bytes) * expected) << bytes;
  }
}

}  // namespace
}  // namespace leviosim::sim
