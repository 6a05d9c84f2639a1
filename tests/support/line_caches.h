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
  LineCaches(const sim::InstructionCacheConfig& config, Bytes own, std::uint64_t seed)
      : config_(config),
        own_lines_(own.count() / config.line.count()),
        random_(seed),
        shared_(config.shared.count() / config.line.count(), config.ways),
        bank_free_(static_cast<std::size_t>(config.shared_banks), 0),
        refill_free_(static_cast<std::size_t>(config.refills), 0) {}

  /// Every core walks through its whole list once; all begin at the same time. Caches keep what
  /// they have from call to call.
  SteppedCaches run(const std::vector<Walker>& walkers) {
    result_ = {};
    cores_.clear();
    while (own_.size() < walkers.size())
      own_.emplace_back(std::max<std::int64_t>(own_lines_, config_.ways), config_.ways);
    for (const Walker& walker : walkers) {
      cores_.push_back({walker, now_, 0});
      result_.cores.emplace_back();
    }
    for (std::size_t id = 0; id < cores_.size(); ++id) go_on(id);
    while (!asking_.empty()) {
      const auto [time, id] = asking_.top();
      asking_.pop();
      Core& core = cores_[id];
      const std::uint32_t line = core.line();
      const double there = answer(line, time);
      result_.cores[id].stall += there - time;
      ++result_.cores[id].requests;
      if (own_lines_ > 0) own_[id].put(line, random_);
      core.time = there + core.walker.work;
      ++core.done;
      go_on(id);
    }
    const double begin = std::exchange(now_, result_.last_end());
    for (SteppedCore& core : result_.cores) core.end -= begin;
    return result_;
  }

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
  void go_on(std::size_t id) {
    Core& core = cores_[id];
    while (core.done < core.walker.lines->size() && own_lines_ > 0 && own_[id].holds(core.line())) {
      core.time += core.walker.work;
      ++core.done;
    }
    if (core.done < core.walker.lines->size())
      asking_.push({core.time, id});
    else
      result_.cores[id].end = core.time;
  }

  /// When a core has the line that it asks for now. Questions come in the order of their times.
  double answer(std::uint32_t line, double now) {
    double& bank = bank_free_[line % bank_free_.size()];
    const double begin = std::max(now, bank);
    if (own_lines_ > 0) bank = begin + 1;  // without private caches, banks are wide enough
    if (line >= coming_.size()) coming_.resize(line + 1, 0);
    if (!shared_.holds(line)) {
      double& refill = *std::min_element(refill_free_.begin(), refill_free_.end());
      refill = std::max(begin, refill) + config_.shared_miss;
      coming_[line] = refill;
      shared_.put(line, random_);
      ++result_.refills;
    }
    const double hit = begin + (own_lines_ > 0 ? config_.shared_hit : 0);
    if (coming_[line] < begin) return hit;
    return std::max(hit, std::exchange(coming_[line], coming_[line] + 1));
  }

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
