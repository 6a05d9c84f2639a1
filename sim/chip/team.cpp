#include "sim/chip/team.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "sim/base/check.h"
#include "sim/events/last_time.h"

namespace leviosim::sim {
namespace {

// Rates are quotients: what is left at the end of a work segment may miss zero by rounding.
constexpr double kNothingLeft = 1e-6;

}  // namespace

Team::Team(const ClusterConfig& config, int workers)
    : config_(config),
      costs_(config.core),
      worker_code_(config.icache, config.icache.worker, std::max(1, workers)),
      master_code_(config.icache, config.icache.master, 1),
      master_(workers),
      contention_(config) {}

void Team::recall(const TeamMemory* memory) {
  recalling_ = memory;
  same_cores_ = memory != nullptr && memory->has_cores_of(config_);
  other_operations_.reset();
  if (memory != nullptr) other_operations_ = memory->operations_that_differ(config_);
  same_sharing_ = memory != nullptr && memory->shares_as(config_);
}

void Team::execute(std::span<TeamShare> shares, const Traffic& traffic, const void* work) {
  Cycles now = Traffic::kNever;
  for (const TeamShare& share : shares) now = std::min(now, share.begin);
  const TeamMemory::Execution* known =
      work == nullptr || recalling_ == nullptr || shares.front().by_operation != nullptr
          ? nullptr
          : recalling_->find(work);
  if (known != nullptr && same_cores_ && repeats(shares, now, traffic, *known)) return;
  price(shares, known);
  if (known != nullptr && !same_cores_ && repeats(shares, now, traffic, *known)) return;
  walk(shares, now, traffic);
  if (learning_ != nullptr && work != nullptr && traffic.next_change(now) == Traffic::kNever)
    learn(shares, now, work);
}

void Team::price(std::span<const TeamShare> shares, const TeamMemory::Execution* known) {
  demands_.resize(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const TeamShare& share = shares[i];
    demands_[i] =
        known != nullptr && (same_cores_ || asks_the_same(*share.work))
            ? (*known)[i].demand
            : demand_of(*share.work, costs_, config_.accelerators,
                        share.core == master_ ? master_code_ : worker_code_, share.by_operation);
  }
}

bool Team::asks_the_same(const work::Segment& segment) const {
  return other_operations_ &&
         std::none_of(other_operations_->begin(), other_operations_->end(),
                      [&](std::size_t operation) { return segment.n[operation] > 0; });
}

bool Team::repeats(std::span<TeamShare> shares, Cycles now, const Traffic& traffic,
                   const TeamMemory::Execution& known) const {
  if (!same_sharing_ || traffic.words(now) != 0) return false;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const TeamMemory::Share& then = known[i];
    if (shares[i].begin - now != then.begin || traffic.next_change(now) < now + then.end)
      return false;
    if (!same_cores_ && std::memcmp(&demands_[i], &then.demand, sizeof then.demand) != 0)
      return false;
  }
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i].end = now + known[i].end;
    shares[i].time = known[i].time;
  }
  return true;
}

void Team::learn(std::span<const TeamShare> shares, Cycles begin, const void* work) {
  TeamMemory::Execution execution;
  for (std::size_t i = 0; i < shares.size(); ++i)
    execution.push_back(
        {shares[i].begin - begin, shares[i].end - begin, demands_[i], shares[i].time});
  learning_->add(work, std::move(execution));
}

void Team::walk(std::span<TeamShare> shares, Cycles now, const Traffic& traffic) {
  bool arrived = true;  // at an instant, where shares may begin; some end as soon as they begin
  for (std::size_t left = shares.size(); left > 0;) {
    Cycles next = traffic.next_change(now);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if (shares[i].begin == now && arrived) begin(shares[i], demands_[i]);
      if (shares[i].begin > now) next = std::min(next, shares[i].begin);
    }
    next = std::min(next, solve(now, traffic.words(now)));
    work(next - now);
    arrived = next > now;
    now = next;
    left -= end_all(now);
  }
}

void Team::begin(TeamShare& share, const Demand& demand) {
  const auto place =
      std::find_if(running_.begin(), running_.end(),
                   [&](const Running& other) { return other.share->core > share.core; }) -
      running_.begin();
  running_.insert(running_.begin() + place, {&share, &demand.alone, demand.cycles()});
  runners_.insert(runners_.begin() + place, Runner::of(share.core, demand));
}

Cycles Team::solve(Cycles now, double dma_words) {
  contention_.solve(runners_, progress_, dma_words);
  Cycles first = Traffic::kNever;
  for (std::size_t i = 0; i < running_.size(); ++i) {
    const double left = std::ceil(running_[i].remaining / progress_[i].rate - kNothingLeft);
    running_[i].end = later(now, counted_cycles(std::max(left, 0.0)));
    first = std::min(first, running_[i].end);
  }
  return first;
}

/// Books the time at the present rates.
void Team::work(Cycles cycles) {
  if (cycles == Cycles(0)) return;
  for (std::size_t i = 0; i < running_.size(); ++i) {
    Running& running = running_[i];
    // The last, partial cycle of a work segment is not lost to anybody: it is rounding.
    const double worked =
        std::min(static_cast<double>(cycles.count()), running.remaining / progress_[i].rate);
    running.remaining -= worked * progress_[i].rate;
    running.share->time.add_waiting(progress_[i].lost, worked);
  }
}

std::size_t Team::end_all(Cycles now) {
  std::size_t ended = 0;
  for (std::size_t i = 0; i < running_.size();) {
    const Running& running = running_[i];
    if (running.end != now) {
      ++i;
      continue;
    }
    TeamShare& share = *running.share;
    share.end = now;
    share.time[Mechanism::Rounding] = static_cast<double>((now - share.begin).count()) -
                                      running.alone->total() - share.time.waiting();
    share.time += *running.alone;
    running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
    runners_.erase(runners_.begin() + static_cast<std::ptrdiff_t>(i));
    ++ended;
  }
  return ended;
}

}  // namespace leviosim::sim
