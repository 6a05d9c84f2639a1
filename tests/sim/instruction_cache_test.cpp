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

/// What a core fetches that executes `body`, which reports to work::code_events.
template <class Body>
CodeReuse fetched_by(CodeTracker& tracker, const Body& body) {
  work::take_tally();
  work::current_code = &tracker;
  body();
  work::fetch_code();
  work::current_code = nullptr;
  return work::take_tally().code;
}

/// A function of `bytes` without calls, called in a loop that is not code itself.
CodeReuse loop_over(std::uint32_t bytes, int rounds) {
  constexpr std::uint32_t kPart = 128;
  CodeMap map;
  for (std::uint32_t part = 0; part < bytes / kPart; ++part)
    map.add("part " + std::to_string(part), "", kPart);
  CodeTracker tracker(map);
  return fetched_by(tracker, [&] {
    for (int round = 0; round < rounds; ++round)
      for (std::uint32_t part = 0; part < bytes / kPart; ++part) {
        work::code_events.enter(CodeName("part " + std::to_string(part)));
        work::code_events.leave();
      }
  });
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
  const CodeReuse code = fetched_by(tracker, [] {
    work::code_events.enter("caller");
    for (int i = 0; i < 3; ++i) {
      work::code_events.enter("leaf");
      work::code_events.leave();
    }
    work::code_events.leave();
  });
  EXPECT_EQ(code[work::kNeverFetched], 320U + 160U + 64U);
  EXPECT_EQ(code[work::reuse_class(160 + 64)], 2 * (160U + 64U)) << "leaf and what follows it";
  EXPECT_EQ(all(code), 320U + 3 * (160U + 64U));
}

TEST(CodeTracker, LoopsOverRoutinesFetchThemInEveryRound) {
  CodeMap map;
  map.add("f64_mul", "", 200);
  map.add("f64_add", "", 120);
  CodeTracker tracker(map);
  const CodeReuse code = fetched_by(tracker, [] {
    for (int i = 0; i < 1000; ++i) {
      work::code_events.call(work::Routine::F64Mul);
      work::code_events.call(work::Routine::F64Add);
    }
  });
  EXPECT_EQ(code[work::kNeverFetched], 200U + 120U);
  EXPECT_EQ(code[work::reuse_class(200 + 120)], 999 * (200U + 120U));
  EXPECT_EQ(all(code), 1000 * (200U + 120U));
}

TEST(CodeTracker, UnknownFunctionsHaveNoCode) {
  CodeMap map;
  map.add("known", "", 64);
  CodeTracker tracker(map);
  const CodeReuse code = fetched_by(tracker, [] {
    work::code_events.enter("unknown");
    work::code_events.leave();
  });
  EXPECT_EQ(all(code), 0U);
}

/// The same by searching the order of all pieces at every visit.
class SearchingTracker {
 public:
  explicit SearchingTracker(const CodeMap& map) : map_(map) {}
  void enter(CodeName function) {
    callers_.push_back(function.key);
    visit(CodeMap::piece_key(function.key, CodeMap::kEntry));
  }
  void leave() {
    const std::uint32_t returned = callers_.back();
    callers_.pop_back();
    if (!callers_.empty()) visit(CodeMap::piece_key(callers_.back(), returned));
  }
  void call(work::Routine routine) {
    visit(CodeMap::piece_key(work::name_of(routine).key, CodeMap::kEntry));
  }
  CodeReuse code{};

 private:
  void visit(std::uint64_t key) {
    const int piece = map_.find(key);
    if (piece == CodeMap::kUnknown) return;
    const CodeMap::Piece& found = map_.pieces()[static_cast<std::size_t>(piece)];
    std::uint32_t distance = found.bytes;
    auto it = order_.begin();
    for (; it != order_.end() && *it != piece; ++it)
      distance += map_.pieces()[static_cast<std::size_t>(*it)].bytes;
    code[it == order_.end() ? work::kNeverFetched : work::reuse_class(distance)] += found.bytes;
    code[work::reuse_class(found.bytes)] += found.again_bytes;
    if (it != order_.end()) order_.erase(it);
    order_.insert(order_.begin(), piece);
  }

  const CodeMap& map_;
  std::vector<std::uint32_t> callers_;
  std::vector<int> order_;
};

TEST(CodeTracker, RandomWalksOfTwoCoresFetchWhatASearchSays) {
  const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f"};
  CodeMap map;
  for (std::size_t i = 0; i < names.size(); ++i) {
    map.add(names[i], "", static_cast<std::uint32_t>(100 + 90 * i), i == 3 ? 40 : 0);
    for (std::size_t k = i + 1; k < names.size(); ++k)
      map.add(names[i], names[k], static_cast<std::uint32_t>(30 + 17 * i + 5 * k));
  }
  map.add("f64_mul", "", 200);
  map.add("f64_add", "", 120);
  struct Core {
    SearchingTracker search;
    int depth = 0;
  };
  std::vector<Core> cores(2, {SearchingTracker(map)});
  CodeTracker tracker(map, 2);
  std::uint32_t random = 1;
  const auto next = [&random](std::uint32_t n) {
    random = random * 1664525u + 1013904223u;
    return (random >> 16) % n;
  };
  const CodeReuse code = fetched_by(tracker, [&] {
    std::uint32_t core = 0;
    std::uint32_t calls = 0;  // of routines in a row: the order of more than 32 is not kept
    for (int step = 0; step < 300'000; ++step) {
      if (next(100) == 0) {
        work::fetch_code();
        core = next(2);
        tracker.select(static_cast<int>(core));
        calls = 0;
      }
      auto& [search, depth] = cores[core];
      const std::uint32_t what = next(4);
      if (what == 0 && depth < 5) {
        const CodeName name(names[next(6)]);
        work::code_events.enter(name);
        search.enter(name);
        calls = 0;
        ++depth;
      } else if (what == 1 && depth > 0) {
        work::code_events.leave();
        search.leave();
        calls = 0;
        --depth;
      } else if (what == 2) {
        for (std::uint32_t n = next(12); n > 0 && calls < 32; --n, ++calls) {
          const auto routine = n % 3 == 0 ? work::Routine::F64Add : work::Routine::F64Mul;
          work::code_events.call(routine);
          search.call(routine);
        }
      }
    }
  });
  CodeReuse expected = cores[0].search.code;
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += cores[1].search.code[i];
  EXPECT_EQ(code, expected);
  EXPECT_GT(all(code), 1'000'000U);
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
