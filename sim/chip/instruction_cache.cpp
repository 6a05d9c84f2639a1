#include "sim/chip/instruction_cache.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace leviosim::sim {
namespace {

/// Adjacent lines of 16 bytes among those that a loop over functions executes: what the two RANSACs
/// have on RV32, over as many fetches as a hypothesis of EPnP has
/// (tests/workload/levio/ransac_code_test.cpp). Other instruction sets are not measured.
constexpr double kStretch = 33 * 16;  // bytes
/// Of an instruction; compressed ones have half of it, which is left out.
constexpr double kInstructionBytes = 4;
/// Share of what a cache holds that is of use while it gets new code.
constexpr double kOfUse = 0.5;

/// Of lines that fall on one set; the highest root of m = 1 - exp(-m lines / ways).
double misses_of_set(int lines, int ways) {
  if (lines <= ways) return 0;
  double misses = 1;
  for (int round = 0; round < 1000; ++round) {
    const double next = 1 - std::exp(-misses * lines / ways);
    if (misses - next < 1e-9) break;
    misses = next;
  }
  return misses;
}

/// Mean over the lines of `stretches` stretches, each of which covers a share of the sets.
double misses_of_stretches(int stretches, double share, int ways) {
  double mean = 0;
  double probability = std::pow(1 - share, stretches - 1);  // that no other covers the set
  if (share == 1) return misses_of_set(stretches, ways);
  for (int others = 0; others < stretches; ++others) {
    mean += probability * misses_of_set(1 + others, ways);
    probability *= (stretches - 1.0 - others) / (others + 1) * share / (1 - share);
  }
  return mean;
}

LoopMisses new_loop_misses(int lines, int ways, double line) {
  const double sets = static_cast<double>(lines) / ways;
  const double stretch = std::min(kStretch / line, sets);
  LoopMisses misses{};
  for (std::size_t k = 0; k < misses.size(); ++k) {
    const double stretches = std::max(1.0, work::kReuseDistances[k] / line / stretch);
    const int fewer = static_cast<int>(stretches);
    const double rest = stretches - fewer;
    misses[k] = (1 - rest) * misses_of_stretches(fewer, stretch / sets, ways) +
                rest * misses_of_stretches(fewer + 1, stretch / sets, ways);
  }
  return misses;
}

CodeFetcher::Level level_of(Bytes size, Bytes line, int ways) {
  if (size == Bytes(0) || line == Bytes(0)) return {};
  const auto bytes = static_cast<double>(size.count());
  const auto lines = static_cast<int>(std::max<std::int64_t>(size.count() / line.count(), ways));
  return {bytes, kOfUse / bytes, &loop_misses(lines, ways, static_cast<int>(line.count()))};
}

using OfClasses = LoopMisses;

/// The fetches of a work segment. Classes that nothing is fetched in are left out.
struct Walk {
  std::size_t classes = 0;
  std::array<std::size_t, work::kReuseDistances.size()> number{};
  OfClasses share{};    ///< of all fetches
  OfClasses repeats{};  ///< fetches in one round of a loop of this size, for each of its lines
  OfClasses follows{};  ///< 1 if the class before has distances of the same loops, else 0
  double first = 0;     ///< share that no cache holds
  double lines = 0;     ///< fetched
};

/// In a round of a loop each line is fetched once at the distance of the loop, and again at smaller
/// ones in loops within it. A distance between two classes counts in both, so neighbours are taken
/// for one loop.
void count_repeats(Walk& walk) {
  double within = 0;
  for (std::size_t i = 0; i < walk.classes; ++i) {
    within += walk.share[i];
    double once = walk.share[i];
    if (i > 0 && walk.number[i - 1] + 1 == walk.number[i]) {
      walk.follows[i] = 1;
      once += walk.share[i - 1];
    }
    if (i + 1 < walk.classes && walk.number[i + 1] == walk.number[i] + 1) once += walk.share[i + 1];
    walk.repeats[i] = std::max(1.0, within / once);
  }
}

Walk walk_of(const work::CodeReuse& code, double line) {
  Walk walk;
  double bytes = 0;
  for (const std::uint64_t n : code) bytes += static_cast<double>(n);
  walk.lines = bytes / line;
  if (bytes == 0) return walk;
  walk.first = static_cast<double>(code[work::kNeverFetched]) / bytes;
  for (std::size_t k = 0; k < work::kReuseDistances.size(); ++k) {
    if (code[k] == 0) continue;
    walk.number[walk.classes] = k;
    walk.share[walk.classes++] = static_cast<double>(code[k]) / bytes;
  }
  count_repeats(walk);
  return walk;
}

/// The same fetches by code that is larger or smaller.
work::CodeReuse resized(const work::CodeReuse& code, double ratio) {
  work::CodeReuse result{};
  for (std::size_t k = 0; k < code.size(); ++k) {
    if (code[k] == 0) continue;
    const auto bytes =
        static_cast<std::uint64_t>(std::llround(static_cast<double>(code[k]) * ratio));
    if (k == work::kNeverFetched) {
      result[k] += bytes;
      continue;
    }
    constexpr std::uint32_t kParts = 1u << 20;
    work::for_reuse_classes(
        static_cast<std::uint32_t>(std::lround(work::kReuseDistances[k] * ratio)), kParts,
        [&](std::size_t to, std::uint32_t parts) { result[to] += bytes * parts / kParts; });
  }
  return result;
}

/// exp(-x), near enough for x above 0, in instructions that compilers make vectors of.
double survival(double x) { return 1 / (1 + x * (1 + x * (0.5 + x / 6))); }

/// Misses of one cache per fetch of a walk.
/// @param missing  in: probability that a fetch of the class asks this cache; out: that it lacks
///                 the line, too
double misses_of(const Walk& walk, const CodeFetcher::Level& cache, OfClasses& missing) {
  constexpr int kMostRounds = 30;
  constexpr double kExact = 1e-4;
  const std::size_t n = walk.classes;
  OfClasses asked;  // share of all fetches
  OfClasses kept;   // in a loop of its own
  OfClasses exposed;
  OfClasses missed;  // share of all fetches
  double all = walk.first;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = walk.number[i];
    asked[i] = walk.share[i] * missing[i];
    kept[i] = 1 - (*cache.loops)[k];
    exposed[i] = cache.exposure * work::kReuseDistances[k];
    missed[i] = asked[i] * (1 - kept[i]);
    all += missed[i];
  }
  // The more is missed, the more is exposed: secant steps on what that adds.
  double all_before = 0;
  double added_before = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    double within = 0;  // misses of smaller loops
    for (std::size_t i = 0; i < n; ++i) {
      const double nearer = i > 0 ? walk.follows[i] * missed[i - 1] : 0;
      const double farther = i + 1 < n ? walk.follows[i + 1] * missed[i + 1] : 0;
      const double of_others =
          (within - nearer) * walk.repeats[i] + std::max(0.0, all - within - missed[i] - farther);
      missed[i] = asked[i] * (1 - kept[i] * survival(of_others * exposed[i]));
      within += missed[i];
    }
    const double sum = walk.first + within;
    const double added = sum - all;
    if (std::abs(added) <= kExact) {
      all = sum;
      break;
    }
    const double falls = added_before - added;  // seldom: it does not, and the step is plain
    const double step =
        round > 0 && falls * (all - all_before) > 0 ? added * (all - all_before) / falls : added;
    all_before = std::exchange(all, std::clamp(all + step, walk.first, 1.0));
    added_before = added;
  }
  for (std::size_t i = 0; i < n; ++i) missing[i] = asked[i] > 0 ? missed[i] / walk.share[i] : 0;
  return all;
}

}  // namespace

const LoopMisses& loop_misses(int lines, int ways, int line) {
  static std::mutex mutex;
  static std::map<std::array<int, 3>, LoopMisses> known;
  const std::scoped_lock lock(mutex);
  const auto [found, is_new] = known.try_emplace({lines, ways, line});
  if (is_new) found->second = new_loop_misses(lines, ways, line);
  return found->second;
}

CodeFetcher::CodeFetcher(const InstructionCacheConfig& config, Bytes own, int sharers)
    : line_(static_cast<double>(config.line.count())),
      shared_hit_(config.shared_hit),
      refill_(config.refill()),
      sharers_(sharers),
      code_size_(config.code_size * config.measured_size),
      own_(level_of(own, config.line, config.ways)),
      shared_(level_of(config.shared, config.line, config.ways)) {}

double CodeFetcher::lines_executed(double instructions) const {
  if (line_ == 0 || own_.bytes > 0 || shared_.bytes == 0) return 0;
  return instructions * kInstructionBytes * code_size_ / line_;
}

std::size_t CodeFetcher::HashOfReuse::operator()(const work::CodeReuse& code) const {
  std::array<std::uint64_t, 4> lanes{};  // that do not wait for each other
  for (std::size_t k = 0; k < code.size(); ++k) {
    std::uint64_t& lane = lanes[k % lanes.size()];
    lane = (lane ^ code[k]) * 0x9e3779b97f4a7c15u;
  }
  std::uint64_t hash = 0;
  for (const std::uint64_t lane : lanes) hash = (hash ^ (lane >> 32) ^ lane) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 32);
}

CodeFetch CodeFetcher::fetch(const work::CodeReuse& code) const {
  if (line_ == 0) return {};
  if (latest_code_ == code) return latest_;
  if (known_.size() == kMostKnown) known_.clear();
  const auto [entry, is_new] = known_.try_emplace(code);
  if (is_new) entry->second = solve(code);
  latest_code_ = code;
  latest_ = entry->second;
  return latest_;
}

CodeFetch CodeFetcher::solve(const work::CodeReuse& code) const {
  const Walk walk = walk_of(code_size_ == 1 ? code : resized(code, code_size_), line_);
  if (walk.lines == 0) return {};
  const bool is_private = own_.bytes > 0;
  OfClasses missing;
  missing.fill(1);
  const double requests = is_private ? misses_of(walk, own_, missing) : 1;
  const double misses = shared_.bytes > 0 ? misses_of(walk, shared_, missing) : requests;
  CodeFetch sum;
  sum.stall =
      walk.lines * (misses * refill_ + (is_private ? (requests - misses) * shared_hit_ : 0.0));
  sum.requests = is_private ? walk.lines * requests : 0;
  sum.refills = walk.lines * misses / sharers_;
  sum.refill_cycles = sum.refills * refill_;
  return sum;
}

}  // namespace leviosim::sim
