#include "tests/support/line_caches.h"

#include <algorithm>
#include <utility>

namespace leviosim::tests {

LineCaches::LineCaches(const sim::InstructionCacheConfig& config, Bytes own, std::uint64_t seed)
    : config_(config),
      own_lines_(own.count() / config.line.count()),
      random_(seed),
      shared_(config.shared.count() / config.line.count(), config.ways),
      bank_free_(static_cast<std::size_t>(config.shared_banks), 0),
      refill_free_(static_cast<std::size_t>(config.refills), 0) {}

SteppedCaches LineCaches::run(const std::vector<Walker>& walkers) {
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

void LineCaches::go_on(std::size_t id) {
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

double LineCaches::answer(std::uint32_t line, double now) {
  double& bank = bank_free_[line % bank_free_.size()];
  const double begin = std::max(now, bank);
  if (own_lines_ > 0) bank = begin + 1;  // without private caches, banks are wide enough
  if (line >= coming_.size()) coming_.resize(line + 1, 0);
  if (!shared_.holds(line)) {
    double& refill = *std::min_element(refill_free_.begin(), refill_free_.end());
    refill = std::max(begin, refill) + config_.refill();
    coming_[line] = refill;
    shared_.put(line, random_);
    ++result_.refills;
  }
  const double hit = begin + (own_lines_ > 0 ? config_.shared_hit : 0);
  if (coming_[line] < begin) return hit;
  return std::max(hit, std::exchange(coming_[line], coming_[line] + 1));
}

}  // namespace leviosim::tests
