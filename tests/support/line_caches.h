// Instruction caches stepped line by line: what sim/chip/instruction_cache.h is compared with.
// Exact and slow. Cores walk through lists of lines; each has a private cache or none, behind them
// is one that they share, in banks, and behind that L2, which refills a few lines at once. All
// caches have sets and replace a line of a set at random.
//
// A core works a fixed time on each line, and waits for one that its private cache lacks: for the
// bank, which answers one request per cycle, and then as many cycles as a hit or a refill takes. A
// line that is on its way is awaited by whoever asks for it, and given to one core per cycle when
// it comes.
//
// Left out: prefetching, and whatever else a core waits for.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/chip/config.h"

namespace leviosim::tests {

using LineList = std::vector<std::uint32_t>;  ///< numbers of the lines that a core executes

class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed * 2 + 1) {}
  std::uint32_t below(std::uint32_t n) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>((state_ >> 33) % n);
  }

 private:
  std::uint64_t state_;
};

/// Sets of ways. A line that comes takes an empty way, or one at random.
class SetsOfLines {
 public:
  SetsOfLines(std::int64_t lines, int ways)
      : ways_(static_cast<std::size_t>(ways)),
        sets_(static_cast<std::size_t>(lines) / ways_),
        held_(sets_ * ways_, kEmpty) {}

  bool holds(std::uint32_t line) const {
    const std::size_t first = line % sets_ * ways_;
    return std::find(held_.begin() + first, held_.begin() + first + ways_, line) !=
           held_.begin() + first + ways_;
  }
  void put(std::uint32_t line, RandomNumbers& random) {
    const std::size_t first = line % sets_ * ways_;
    const auto begin = held_.begin() + first;
    const auto empty = std::find(begin, begin + ways_, kEmpty);
    *(empty != begin + ways_ ? empty : begin + random.below(static_cast<std::uint32_t>(ways_))) =
        line;
  }

 private:
  static constexpr std::uint32_t kEmpty = ~0u;
  std::size_t ways_;
  std::size_t sets_;
  std::vector<std::uint32_t> held_;
};

struct SteppedCore {
  double stall = 0;  ///< cycles waited for lines
  double end = 0;    ///< when it is through
  std::uint64_t requests = 0;
};
struct SteppedCaches {
  std::vector<SteppedCore> cores;
  std::uint64_t refills = 0;

  double mean_stall() const {
    double sum = 0;
    for (const SteppedCore& core : cores) sum += core.stall;
    return sum / static_cast<double>(cores.size());
  }
  double last_end() const {
    double end = 0;
    for (const SteppedCore& core : cores) end = std::max(end, core.end);
    return end;
  }
};

/// What one core does: its lines, how long it works on each, and where it begins in its list, at
/// whose end it goes on at the begin.
struct Walker {
  const LineList* lines = nullptr;
  double work = 5;
  std::size_t begin = 0;
};

class LineCaches {
 public:
  /// @param own  size of the private caches; 0 for none
  LineCaches(const sim::InstructionCacheConfig& config, Bytes own, std::uint64_t seed);

  /// Every core walks through its whole list once; all begin at the same time. Caches keep what
  /// they have from call to call.
  SteppedCaches run(const std::vector<Walker>& walkers);

 private:
  struct Core {
    Walker walker;
    double time;
    std::size_t done;

    std::uint32_t line() const {
      return (*walker.lines)[(walker.begin + done) % walker.lines->size()];
    }
  };

  /// Up to the next line that the private cache lacks: that concerns nobody else.
  void go_on(std::size_t id);
  /// When a core has the line that it asks for now. Questions come in the order of their times.
  double answer(std::uint32_t line, double now);

  sim::InstructionCacheConfig config_;
  std::int64_t own_lines_;
  RandomNumbers random_;
  SetsOfLines shared_;
  std::vector<double> bank_free_;
  std::vector<double> refill_free_;
  std::vector<double> coming_;  ///< by line: when it is here for the next core
  std::vector<Core> cores_;
  std::vector<SetsOfLines> own_;
  double now_ = 0;
  using Question = std::pair<double, std::size_t>;
  std::priority_queue<Question, std::vector<Question>, std::greater<>> asking_;
  SteppedCaches result_;
};

}  // namespace leviosim::tests
