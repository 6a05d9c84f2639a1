// Fetching code: reuse distances of known walks, misses of random replacement against closed
// formulas, and what a team shares. Against caches that are stepped: code_lines_test.cpp and
// tests/workload/levio/ransac_code_test.cpp.
#include "sim/chip/instruction_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/chip/cost.h"
#include "sim/work/code_tracker.h"
#include "tests/sim/chip_test_config.h"

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

/// Of what is fetched again.
double mean_distance(const CodeReuse& code) {
  double sum = 0;
  double bytes = 0;
  for (std::size_t k = 0; k < work::kReuseDistances.size(); ++k) {
    sum += static_cast<double>(code[k]) * work::kReuseDistances[k];
    bytes += static_cast<double>(code[k]);
  }
  return sum / bytes;
}

TEST(CodeReuse, ClassesKeepTheMeanDistance) {
  for (std::uint32_t distance = 256; distance <= work::kFarthestReuse; distance += 61) {
    CodeReuse code{};
    work::for_reuse_classes(distance, 100'000,
                            [&](std::size_t k, std::uint32_t bytes) { code[k] += bytes; });
    EXPECT_EQ(all(code), 100'000U);
    EXPECT_NEAR(mean_distance(code), distance, 0.1) << distance;
  }
}

TEST(CodeReuse, BeyondTheClassesCodeIsNearOrNew) {
  const auto add = [](std::uint32_t distance) {
    std::size_t only = 0;
    work::for_reuse_classes(distance, 64, [&](std::size_t k, std::uint32_t bytes) {
      EXPECT_EQ(bytes, 64U);
      only = k;
    });
    return only;
  };
  EXPECT_EQ(add(16), 0U);
  EXPECT_EQ(add(65536), work::kReuseDistances.size() - 1);
  EXPECT_EQ(add(65537), work::kNeverFetched);
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
  // 320 bytes lie between the classes of 304 and 362.
  EXPECT_EQ(code[work::reuse_class(304)] + code[work::reuse_class(362)], 999 * (200U + 120U));
  EXPECT_NEAR(mean_distance(code), 320, 1);
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
    const auto add = [this](std::size_t k, std::uint32_t bytes) { code[k] += bytes; };
    if (it == order_.end())
      add(work::kNeverFetched, found.bytes);
    else
      work::for_reuse_classes(distance, found.bytes, add);
    if (found.again_bytes > 0) work::for_reuse_classes(found.bytes, found.again_bytes, add);
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

/// A loop of so many bytes that has gone round often, on caches that are alike.
CodeReuse round_and_round(std::uint32_t bytes, std::uint64_t rounds = 1000) {
  CodeReuse code{};
  work::for_reuse_classes(bytes, bytes,
                          [&](std::size_t k, std::uint32_t n) { code[k] += rounds * n; });
  return code;
}

/// Share of the lines of a loop that a lone cache misses: its refills.
double miss_share(std::uint32_t bytes, Bytes cache) {
  InstructionCacheConfig c = caches();
  c.shared = cache;
  const CodeReuse code = round_and_round(bytes);
  return CodeFetcher(c, Bytes(0), 1).fetch(code).refills * 16 / static_cast<double>(all(code));
}

TEST(InstructionCache, SmallLoopsAreNotMissed) {
  for (const std::uint32_t bytes : {256U, 512U, 1024U})
    EXPECT_LT(miss_share(bytes, Bytes(4096)), 1e-9) << bytes;
  // Half of the cache in functions that lie together: few sets get more lines than ways.
  EXPECT_LT(miss_share(2048, Bytes(4096)), 0.03);
}

TEST(InstructionCache, LoopsInOneSetSatisfyTheirEquation) {
  const LoopMisses& misses = loop_misses(512, 512, 16);
  for (std::size_t k = 0; k < misses.size(); ++k) {
    const double ratio = work::kReuseDistances[k] / 8192.0;
    if (ratio <= 1)
      EXPECT_EQ(misses[k], 0) << k;
    else
      EXPECT_NEAR(misses[k], 1 - std::exp(-misses[k] * ratio), 2e-3) << k;
  }
}

/// A loop fills a cache by its bytes, whatever the lines that they come in.
TEST(InstructionCache, LoopsAreMissedAlikeWithLinesOfAnySize) {
  const LoopMisses& of_16 = loop_misses(256, 4, 16);
  for (const int line : {8, 32}) {
    const LoopMisses& misses = loop_misses(4096 / line, 4, line);
    for (std::size_t k = 0; k < misses.size(); ++k) EXPECT_NEAR(misses[k], of_16[k], 1e-9) << k;
  }
}

TEST(InstructionCache, LargerLoopsAreMissedMoreAndMoreWaysHelpSmallOnes) {
  for (const int ways : {1, 2, 4, 8}) {
    const LoopMisses& misses = loop_misses(256, ways, 16);
    EXPECT_TRUE(std::is_sorted(misses.begin(), misses.end()));
    EXPECT_LE(misses.back(), 1);
    EXPECT_GE(misses[work::reuse_class(3444)],
              loop_misses(256, 2 * ways, 16)[work::reuse_class(3444)]);
  }
}

TEST(InstructionCache, LargerCodeOrSmallerCachesAreMissedMore) {
  for (const std::uint32_t bytes : {3000U, 4096U, 5000U, 8192U, 16384U, 40000U}) {
    EXPECT_LE(miss_share(bytes, Bytes(4096)), miss_share(bytes + bytes / 20, Bytes(4096)) + 1e-9);
    EXPECT_GE(miss_share(bytes, Bytes(4096)), miss_share(bytes, Bytes(8192)) - 1e-9);
  }
}

TEST(InstructionCache, CodeBetweenOtherCodeIsMissedThoughItWouldFit) {
  // Half of the fetches are of 3 kB, which would fit; the others are new and throw them out.
  CodeReuse code = round_and_round(3000);
  code[work::kNeverFetched] = all(code);
  const CodeFetcher fetcher(caches(), Bytes(0), 1);
  const double lines = static_cast<double>(all(code)) / 16;
  EXPECT_GT(fetcher.fetch(code).refills, 0.55 * lines);
  EXPECT_LT(fetcher.fetch(code).refills, 0.9 * lines);
}

TEST(InstructionCache, ATeamSharesTrafficAndWaitsAsALoneCore) {
  for (const std::uint32_t bytes : {2048U, 4871U, 16384U}) {
    const CodeReuse code = round_and_round(bytes);
    const CodeFetch alone = CodeFetcher(caches(), caches().worker, 1).fetch(code);
    const CodeFetch together = CodeFetcher(caches(), caches().worker, 8).fetch(code);
    EXPECT_DOUBLE_EQ(together.stall, alone.stall);
    EXPECT_DOUBLE_EQ(together.requests, alone.requests);
    EXPECT_DOUBLE_EQ(8 * together.refills, alone.refills);
    EXPECT_DOUBLE_EQ(8 * together.refill_cycles, alone.refill_cycles);
  }
}

/// Twice the code is the same as a loop of twice the bytes.
TEST(InstructionCache, FetchesCodeOfAnotherSize) {
  InstructionCacheConfig twice = caches();
  twice.code_size = 2;
  for (const std::uint32_t bytes : {300U, 1024U, 3000U, 8192U}) {
    const CodeFetch expected =
        CodeFetcher(caches(), caches().worker, 1).fetch(loop_over(2 * bytes, 50));
    const CodeFetch found = CodeFetcher(twice, twice.worker, 1).fetch(loop_over(bytes, 50));
    EXPECT_NEAR(found.stall, expected.stall, 0.02 * expected.stall + 1) << bytes;
    EXPECT_NEAR(found.refills, expected.refills, 0.02 * expected.refills + 1) << bytes;
  }
}

TEST(InstructionCache, StepsAtEachCapacity) {
  const CodeFetcher fetcher(caches(), caches().worker, 1);
  const auto stall_per_line = [&](std::uint32_t bytes) {
    const CodeFetch few = fetcher.fetch(loop_over(bytes, 10));
    const CodeFetch many = fetcher.fetch(loop_over(bytes, 110));  // less the first round
    return (many.stall - few.stall) / (100.0 * bytes / 16);
  };
  EXPECT_LT(stall_per_line(512), 0.1);
  EXPECT_NEAR(stall_per_line(2048), 2, 0.2)
      << "private misses, shared hits but for one in a hundred";
  EXPECT_NEAR(stall_per_line(16384), 20, 0.6) << "L2";
}

/// All bytes of new code come through the same width; lines save the waiting before each.
TEST(InstructionCache, LongerLinesComeInMoreBeats) {
  CodeReuse code{};
  code[work::kNeverFetched] = 65536;
  InstructionCacheConfig c = caches();
  c.shared_miss = 18;
  c.refill_width = 8;
  for (const int line : {8, 16, 32, 64}) {
    c.line = Bytes(line);
    const CodeFetch fetch = CodeFetcher(c, c.worker, 2).fetch(code);
    EXPECT_DOUBLE_EQ(fetch.stall, 65536.0 / line * 18 + 65536 / 8.0) << line;
    EXPECT_DOUBLE_EQ(fetch.refill_cycles, fetch.stall / 2) << line;
  }
}

/// What was asked before, by whomever, is remembered.
TEST(InstructionCache, AnswersDoNotDependOnWhatWasAskedBefore) {
  const CodeReuse small = loop_over(1024, 3), large = loop_over(6144, 3);
  const CodeFetcher asked(caches(), Bytes(512), 1);
  for (const CodeReuse& code : {small, large, small, small, CodeReuse{}, large}) {
    const CodeFetch fetch = asked.fetch(code);
    EXPECT_EQ(fetch.stall, CodeFetcher(caches(), Bytes(512), 1).fetch(code).stall);
    const CodeFetcher copy = asked;
    EXPECT_EQ(copy.fetch(code).stall, fetch.stall);
  }
  EXPECT_GT(asked.fetch(large).stall, asked.fetch(small).stall);
}

TEST(InstructionCache, WithoutAPrivateCacheEachLineExecutedComesFromTheSharedOne) {
  const CodeFetcher fetcher(caches(), Bytes(0), 1);
  const CodeFetch fetch = fetcher.fetch(loop_over(1024, 1000));
  EXPECT_EQ(fetch.requests, 0);
  EXPECT_NEAR(fetch.stall, 20 * 1024 / 16.0, 0.2 * 20 * 1024 / 16.0)
      << "only the first round comes from L2, and what it throws out";
  const double lines = fetcher.lines_executed(256'000);  // 1000 rounds of 256 instructions
  EXPECT_DOUBLE_EQ(lines, 64'000);
  EXPECT_DOUBLE_EQ(fetcher.wait_for_lines(lines, fetch), 2 * (lines - fetch.refills));
  const CodeFetcher with_one(caches(), Bytes(512), 1);
  EXPECT_EQ(with_one.lines_executed(256'000), 0);

  work::Counts work = alu(256'000);
  work.code = loop_over(1024, 1000);
  EXPECT_DOUBLE_EQ(demand_of(work, unit_cost_core(), fetcher).alone[Mechanism::Fetch],
                   fetch.stall + 2 * (lines - fetch.refills));
  EXPECT_DOUBLE_EQ(demand_of(work, unit_cost_core(), with_one).alone[Mechanism::Fetch],
                   with_one.fetch(work.code).stall);
}

}  // namespace
}  // namespace leviosim::sim
