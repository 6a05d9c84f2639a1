// Fetching code: reuse distances of known walks, misses of random replacement against closed
// formulas and against a simulated cache, and what a team shares.
#include "sim/chip/instruction_cache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/work/code_tracker.h"

namespace leviosim::sim {
namespace {

using work::CodeMap;
using work::CodeName;
using work::CodeReuse;
using work::CodeTracker;

InstructionCacheConfig caches() {
  InstructionCacheConfig c;
  c.line = Bytes(16);
  c.worker = Bytes(512);
  c.master = Bytes(2048);
  c.shared = Bytes(4096);
  c.shared_banks = 2;
  c.shared_hit = 2;
  c.shared_miss = 20;
  return c;
}

/// A function of `bytes` without calls, called in a loop that is not code itself.
CodeReuse loop_over(std::uint32_t bytes, int rounds) {
  constexpr std::uint32_t kPart = 128;
  CodeMap map;
  for (std::uint32_t part = 0; part < bytes / kPart; ++part)
    map.add("part " + std::to_string(part), "", kPart);
  CodeTracker tracker(map);
  work::take_tally();
  for (int round = 0; round < rounds; ++round)
    for (std::uint32_t part = 0; part < bytes / kPart; ++part) {
      tracker.enter(CodeName("part " + std::to_string(part)).key);
      tracker.leave();
    }
  return work::take_tally().code;
}

std::uint64_t all(const CodeReuse& code) {
  std::uint64_t sum = 0;
  for (const std::uint64_t bytes : code) sum += bytes;
  return sum;
}

TEST(CodeTracker, ALoopReusesItsCodeAtItsOwnLength) {
  const CodeReuse code = loop_over(1024, 10);
  EXPECT_EQ(all(code), 10'240U);
  EXPECT_EQ(code[work::kNeverFetched], 1024U);
  EXPECT_EQ(code[work::reuse_class(1024)], 9 * 1024U);
}

TEST(CodeTracker, ReturnsFetchTheRestOfTheCaller) {
  CodeMap map;
  map.add("caller", "", 320);
  map.add("caller", "leaf", 160);
  map.add("leaf", "", 64);
  CodeTracker tracker(map);
  work::take_tally();
  tracker.enter(CodeName("caller").key);
  for (int i = 0; i < 3; ++i) {
    tracker.enter(CodeName("leaf").key);
    tracker.leave();
  }
  tracker.leave();
  const CodeReuse code = work::take_tally().code;
  EXPECT_EQ(code[work::kNeverFetched], 320U + 160U + 64U);
  EXPECT_EQ(code[work::reuse_class(160 + 64)], 2 * (160U + 64U)) << "leaf and what follows it";
  EXPECT_EQ(all(code), 320U + 3 * (160U + 64U));
}

TEST(CodeTracker, UnknownFunctionsHaveNoCode) {
  CodeMap map;
  map.add("known", "", 64);
  CodeTracker tracker(map);
  work::take_tally();
  tracker.enter(CodeName("unknown").key);
  tracker.leave();
  EXPECT_EQ(all(work::take_tally().code), 0U);
}

TEST(InstructionCache, NothingIsMissedBelowTheCapacity) {
  for (const int sharers : {1, 2, 8}) {
    EXPECT_EQ(miss_share(0.5, sharers), 0);
    EXPECT_EQ(miss_share(1.0, sharers), 0);
    EXPECT_GT(miss_share(1.1, sharers), 0.08);
  }
}

TEST(InstructionCache, OneCoreInALoopSatisfiesItsEquation) {
  for (const double reuse : {1.2, 1.5, 2.0, 3.0}) {
    const double m = miss_share(reuse, 1);
    EXPECT_NEAR(m, 1 - std::exp(-m * reuse), 1e-5);
  }
  EXPECT_NEAR(miss_share(2.0, 1), 0.797, 0.001);
}

TEST(InstructionCache, ManyCoresHitWhatTheCapacityHolds) {
  // Infinitely many cores at random places of a loop ask for its lines at random: C/d of them hit.
  EXPECT_NEAR(miss_share(2.0, 1000), 0.5, 0.01);
  EXPECT_NEAR(miss_share(4.0, 1000), 0.75, 0.01);
  EXPECT_LT(miss_share(2.0, 8), miss_share(2.0, 2));
}

/// Steps a fully associative cache of random replacement; returns the share of misses.
double simulated_misses(int lines_of_loop, int lines_of_cache, int cores) {
  std::uint64_t state = 1;
  const auto random = [&](int n) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<int>((state >> 33) % static_cast<std::uint64_t>(n));
  };
  std::vector<int> slot_of(static_cast<std::size_t>(lines_of_loop), -1);
  std::vector<int> line_in(static_cast<std::size_t>(lines_of_cache), -1);
  double misses = 0;
  double fetches = 0;
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<int> at(static_cast<std::size_t>(cores));
    for (int& place : at) place = random(lines_of_loop);
    for (int step = 0; step < 4 * lines_of_loop; ++step)
      for (int& place : at) {
        place = (place + 1) % lines_of_loop;
        const bool counts = step >= 2 * lines_of_loop;
        fetches += counts;
        if (slot_of[static_cast<std::size_t>(place)] >= 0) continue;
        misses += counts;
        const int victim = random(lines_of_cache);
        int& held = line_in[static_cast<std::size_t>(victim)];
        if (held >= 0) slot_of[static_cast<std::size_t>(held)] = -1;
        held = place;
        slot_of[static_cast<std::size_t>(place)] = victim;
      }
  }
  return misses / fetches;
}

TEST(InstructionCache, AgreesWithASteppedCache) {
  for (const int cores : {1, 4, 8})
    for (const int lines : {384, 512, 1024})
      EXPECT_NEAR(miss_share(lines / 256.0, cores), simulated_misses(lines, 256, cores), 0.04)
          << cores << " cores, loop of " << lines << " lines, cache of 256";
}

TEST(InstructionCache, StepsAtEachCapacity) {
  const CodeFetcher fetcher(caches(), caches().worker, 1);
  const auto stall_per_line = [&](std::uint32_t bytes) {
    const CodeFetch few = fetcher.fetch(loop_over(bytes, 10));
    const CodeFetch many = fetcher.fetch(loop_over(bytes, 110));  // less the first round
    return (many.stall - few.stall) / (100.0 * bytes / 16);
  };
  EXPECT_EQ(stall_per_line(512), 0);
  EXPECT_NEAR(stall_per_line(2048), 2, 0.1) << "private misses, shared hits";
  EXPECT_NEAR(stall_per_line(16384), 20, 0.6) << "L2";
}

TEST(InstructionCache, WithoutAPrivateCacheTheSharedOneAnswersAtOnce) {
  const CodeFetcher fetcher(caches(), Bytes(0), 1);
  const CodeFetch fetch = fetcher.fetch(loop_over(1024, 1000));
  EXPECT_EQ(fetch.requests, 0);
  EXPECT_NEAR(fetch.stall, 20 * 1024 / 16.0, 1e-9) << "only the first round comes from L2";
}

}  // namespace
}  // namespace leviosim::sim
