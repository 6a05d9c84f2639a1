#include "sim/chip/contention.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leviosim::sim {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// The limits of one unit depend on the rates that the others allow. A few rounds settle it; the
// bound only keeps a pathological mix from going on for ever.
constexpr int kMaxRounds = 32;
constexpr double kSettled = 1e-9;

constexpr std::size_t index(Unit unit) { return static_cast<std::size_t>(unit); }

/// That waiting for a unit is.
Mechanism mechanism_of(Unit unit) {
  switch (unit) {
    case Unit::Divider:
      return Mechanism::Divider;
    case Unit::Bank:
    case Unit::L1:
      return Mechanism::Banks;
    case Unit::Refill:
      return Mechanism::FetchContention;
    case Unit::Fpu:
    case Unit::Int64:
      return Mechanism::Fpu;
    default:
      return Mechanism::AcceleratorContention;
  }
}

/// The request rate to which units of the given number hold their requesters back: infinite if they
/// serve everybody. Water filling from the smallest demand upwards.
double fair_rate(std::vector<UnitRequest>& requests, double units) {
  double demand = 0;
  double busy = 0;  // of one request of everybody who is not served yet
  for (const UnitRequest& r : requests) {
    demand += r.per_cycle * r.busy;
    busy += r.busy;
  }
  if (demand <= units) return kUnlimited;
  std::sort(requests.begin(), requests.end(), [](const UnitRequest& a, const UnitRequest& b) {
    return a.per_cycle != b.per_cycle ? a.per_cycle < b.per_cycle : a.runner < b.runner;
  });
  double left = units;
  for (const UnitRequest& r : requests) {
    const double share = left / busy;
    if (r.per_cycle > share) return share;
    left -= r.per_cycle * r.busy;
    busy -= r.busy;
  }
  return kUnlimited;
}

void apply(const std::vector<UnitRequest>& requests, double fair, std::vector<double>& limits) {
  if (fair == kUnlimited) return;
  for (const UnitRequest& r : requests)
    limits[r.runner] = std::min(limits[r.runner], fair / r.per_lone_cycle);
}

}  // namespace

Runner Runner::of(int core, const Demand& demand) {
  const double cycles = std::max(demand.cycles(), 1.0);
  Runner runner{core, demand.units, demand.streamed / cycles, demand.scattered / cycles,
                demand.fetches / cycles};
  for (UnitDemand& unit : runner.units) {
    unit.requests /= cycles;
    unit.cycles /= cycles;
  }
  const double accesses = runner.streamed + runner.scattered;
  runner.units[index(Unit::L1)] = {accesses, accesses};
  return runner;
}

Contention::Contention(const ClusterConfig& config)
    : banks_(config.l1.banks),
      code_banks_(config.icache.shared_banks),
      stream_conflicts_(config.l1.stream_conflicts),
      collisions_(config.fpu.collisions) {
  const FpuConfig& fpu = config.fpu;
  const auto mapped = [&](int units) {
    return fpu.mapping == FpuMapping::Fixed ? Pools{units, 1.0}
                                            : Pools{1, static_cast<double>(units)};
  };
  pools_[index(Unit::Fpu)] = mapped(fpu.units);
  pools_[index(Unit::Divider)] = {1, static_cast<double>(fpu.dividers)};
  pools_[index(Unit::Int64)] = mapped(fpu.int64_units);
  pools_[index(Unit::Bank)] = {1, 1.0};
  pools_[index(Unit::Refill)] = {1, config.icache.refills};
  shared_ = {Unit::Fpu, Unit::Divider, Unit::Int64, Unit::Bank, Unit::L1, Unit::Refill};
  if (fpu.dividers > 0) queues_.push_back(Unit::Divider);
  for (const work::OffloadKindInfo& info : work::kOffloadKinds) {
    const int units = config.accelerators[work::index(info.kernel)].units;
    if (units == 0) continue;
    shared_.push_back(accelerator_of(info.kernel));
    queues_.push_back(shared_.back());
    pools_[index(shared_.back())] = {1, static_cast<double>(units)};
  }
}

/// Finds the highest rates that the units of one kind allow at the present rates.
void Contention::limit(std::size_t unit, const std::vector<Runner>& runners) {
  std::vector<double>& limits = limits_[unit];
  limits.assign(runners.size(), kUnlimited);
  const Pools& kind = pools_[unit];
  for (int pool = 0; pool < kind.pools; ++pool) {
    requests_.clear();
    for (std::size_t i = 0; i < runners.size(); ++i) {
      const UnitDemand& demand = runners[i].units[unit];
      if (demand.requests > 0 && pool_of_[unit][i] == pool)
        requests_.push_back(
            {i, demand.requests, demand.requests * rate_[i], demand.cycles / demand.requests});
    }
    apply(requests_, fair_rate(requests_, kind.capacity), limits);
  }
}

/// Whether the units serve all requests at the highest rates, which are 1.
bool Contention::serves_everybody(Unit unit, const std::vector<Runner>& runners) {
  const Pools& kind = pools_[index(unit)];
  if (kind.pools == 0) return true;
  demand_.assign(static_cast<std::size_t>(kind.pools), 0.0);
  for (std::size_t i = 0; i < runners.size(); ++i) {
    const UnitDemand& asked = runners[i].units[index(unit)];
    if (asked.requests > 0)
      demand_[static_cast<std::size_t>(pool_of_[index(unit)][i])] +=
          asked.requests * (asked.cycles / asked.requests);
  }
  return std::none_of(demand_.begin(), demand_.end(),
                      [&](double demand) { return demand > kind.capacity; });
}

/// The rate that all kinds of units but one allow a runner.
double Contention::allowed(std::size_t runner, std::size_t except) const {
  double rate = kUnlimited;
  for (const Unit unit : shared_)
    if (index(unit) != except) rate = std::min(rate, limits_[index(unit)][runner]);
  return rate;
}

void Contention::sum_up(const std::vector<Runner>& runners, double dma_words) {
  runners_ = &runners;
  dma_words_ = dma_words;
  all_streamed_ = all_scattered_ = all_fetches_ = 0;
  for (std::size_t i = 0; i < runners.size(); ++i) {
    all_streamed_ += runners[i].streamed * rate_[i];
    all_scattered_ += runners[i].scattered * rate_[i];
    all_fetches_ += runners[i].fetches * rate_[i];
  }
}

double Contention::l1_delay(std::size_t i) const {
  const Runner& me = (*runners_)[i];
  const double scattered = all_scattered_ - me.scattered * rate_[i] + dma_words_;
  const double streamed = all_streamed_ - me.streamed * rate_[i];
  const double beside_streams = scattered + stream_conflicts_ * streamed;
  return (me.scattered * (scattered + streamed) + me.streamed * beside_streams) / (2.0 * banks_);
}

double Contention::fetch_delay(std::size_t i) const {
  const Runner& me = (*runners_)[i];
  return me.fetches * (all_fetches_ - me.fetches * rate_[i]) / (2.0 * code_banks_);
}

void Contention::collide() {
  if (collisions_ == 0) return;
  const std::vector<Runner>& runners = *runners_;
  const std::size_t n = runners.size();
  // What else slows a core down keeps it from asking as often.
  for (std::size_t i = 0; i < n; ++i) pace_[i] = std::min(1.0, rate_[i] * (1 + colliding_[i]));
  colliding_.assign(n, 0.0);
  for (const Unit unit : {Unit::Fpu, Unit::Int64}) {
    const Pools& kind = pools_[index(unit)];
    if (kind.pools == 0 || kind.capacity != 1) continue;
    const std::vector<int>& pool_of = pool_of_[index(unit)];
    asked_.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      asked_[i] = std::min(1.0, runners[i].units[index(unit)].cycles * pace_[i]);
    const auto collisions_of = [&](std::size_t i, std::size_t j) {
      const double run = runners[i].units[index(unit)].run;
      const double other_run = runners[j].units[index(unit)].run;
      return run > 0 && other_run > 0 ? collisions_in_runs(asked_[i], run, asked_[j], other_run)
                                      : collisions_by_chance(asked_[i], asked_[j]);
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (asked_[i] == 0) continue;
      double colliding = colliding_[i];
      for (std::size_t j = 0; j < n; ++j)
        if (pool_of[j] == pool_of[i] && j != i)
          colliding += collisions_ * collisions_of(i, j) / pace_[i];
      colliding_[i] = colliding;
    }
  }
}

void Contention::queue() {
  if (collisions_ == 0) return;
  for (const Unit unit : queues_) queue_at(unit);
}

void Contention::queue_at(Unit unit) {
  const std::size_t k = index(unit);
  const double units = pools_[k].capacity;
  const std::vector<Runner>& runners = *runners_;
  const std::size_t n = runners.size();
  double asking = 0;
  double busy = 0;  // units, on average
  for (std::size_t i = 0; i < n; ++i) {
    asking += runners[i].units[k].requests > 0 ? 1 : 0;
    busy += runners[i].units[k].cycles * rate_[i];
  }
  if (asking <= units) return;
  std::vector<double>& waiting = waiting_[k];
  // With several units a request waits only while all are busy, and for the first that ends.
  const double all_busy = std::pow(std::min(1.0, busy / units), units - 1) / units;
  for (std::size_t i = 0; i < n; ++i) {
    if (runners[i].units[k].requests == 0) continue;
    double behind = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const UnitDemand& other = runners[j].units[k];
      if (j != i && other.requests > 0)
        behind +=
            queued_behind({other.requests * rate_[j], other.cycles / other.requests, waiting[j]});
    }
    waiting[i] = (waiting[i] + collisions_ * all_busy * behind) / 2;  // damped
  }
}

double Contention::queued(Unit unit, std::size_t i) const {
  return (*runners_)[i].units[index(unit)].requests * waiting_[index(unit)][i];
}

double Contention::queued(std::size_t i) const {
  double cycles = 0;
  for (const Unit unit : queues_) cycles += queued(unit, i);
  return cycles;
}

/// Books the time that a runner loses on what it waits for.
void Contention::book_losses(std::size_t i, Progress& p) const {
  CoreCycles& on = p.lost;
  on[Mechanism::Banks] = p.rate * l1_delay(i);
  on[Mechanism::FetchContention] = p.rate * fetch_delay(i);
  on[Mechanism::Fpu] = p.rate * colliding_[i];
  double lost =
      1.0 - p.rate - on[Mechanism::Banks] - on[Mechanism::FetchContention] - on[Mechanism::Fpu];
  for (const Unit unit : queues_) {
    const double waited = p.rate * queued(unit, i);
    on[mechanism_of(unit)] += waited;
    lost -= waited;
  }
  const auto tightest = std::min_element(shared_.begin(), shared_.end(), [&](Unit a, Unit b) {
    return limits_[index(a)][i] < limits_[index(b)][i];
  });
  on[mechanism_of(*tightest)] += std::max(0.0, lost);
}

void Contention::solve(const std::vector<Runner>& runners, std::vector<Progress>& progress,
                       double dma_words) {
  const std::size_t n = runners.size();
  rate_.assign(n, 1.0);
  for (const Unit unit : shared_) limits_[index(unit)].assign(n, kUnlimited);
  progress.assign(n, Progress{});
  colliding_.assign(n, 0.0);
  for (const Unit unit : queues_) waiting_[index(unit)].assign(n, 0.0);
  pace_.assign(n, 1.0);
  if (n < 2 && dma_words == 0) return;

  // What the DMA moves, up to half of what there is.
  pools_[index(Unit::L1)] = {1, std::max(banks_ - dma_words, 0.5 * banks_)};
  for (const Unit unit : shared_) {
    std::vector<int>& pool_of = pool_of_[index(unit)];
    const int pools = pools_[index(unit)].pools;
    pool_of.resize(n);
    for (std::size_t i = 0; i < n; ++i) pool_of[i] = pools > 1 ? runners[i].core % pools : 0;
  }
  std::array<Unit, kUnitCount> scarce{};
  std::size_t scarce_units = 0;
  for (const Unit unit : shared_)
    if (!serves_everybody(unit, runners)) scarce[scarce_units++] = unit;

  free_rate_.resize(n);
  for (int round = 0; round < kMaxRounds; ++round) {
    double change = 0;
    sum_up(runners, dma_words);
    collide();
    queue();
    for (std::size_t i = 0; i < n; ++i)
      free_rate_[i] = 1.0 / (1.0 + l1_delay(i) + fetch_delay(i) + colliding_[i] + queued(i));
    // Each unit's limit is found with what the *other* limits leave of the demand.
    for (std::size_t k = 0; k < scarce_units; ++k) {
      const std::size_t unit = index(scarce[k]);
      for (std::size_t i = 0; i < n; ++i) rate_[i] = std::min(free_rate_[i], allowed(i, unit));
      limit(unit, runners);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double rate = scarce_units == 0
                              ? free_rate_[i]
                              : std::min(free_rate_[i], allowed(i, index(Unit::Core)));
      change = std::max(change, std::abs(rate - progress[i].rate));
      rate_[i] = progress[i].rate = rate;
    }
    if (change < kSettled) break;
  }
  sum_up(runners, dma_words);
  for (std::size_t i = 0; i < n; ++i) book_losses(i, progress[i]);
}

}  // namespace leviosim::sim
