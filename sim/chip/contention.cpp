#include "sim/chip/contention.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leviosim::sim {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// A few rounds settle the rates; the bound only keeps a pathological mix from going on for ever.
constexpr int kMaxRounds = 32;
constexpr double kSettled = 1e-9;

constexpr std::size_t index(Unit unit) { return static_cast<std::size_t>(unit); }

static_assert(kUnitCount <= 32, "Runner::asks has a bit for each unit");
constexpr std::uint32_t bit(Unit unit) { return std::uint32_t{1} << index(unit); }

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
  Runner runner{.core = core,
                .units = demand.units,
                .streamed = demand.streamed / cycles,
                .scattered = demand.scattered / cycles,
                .fetches = demand.fetches / cycles};
  const double accesses = runner.streamed + runner.scattered;
  runner.asks = accesses > 0 ? bit(Unit::L1) : 0;
  for (std::size_t k = 0; k < kUnitCount; ++k) {
    UnitDemand& unit = runner.units[k];
    if (unit.requests == 0 && unit.cycles == 0) continue;
    unit.requests /= cycles;
    unit.cycles /= cycles;
    runner.asks |= std::uint32_t{1} << k;
  }
  runner.units[index(Unit::L1)] = {accesses, accesses};
  return runner;
}

Contention::Contention(const ClusterConfig& config)
    : banks_(config.l1.banks),
      wait_for_bank_(1 / (2.0 * config.l1.banks)),
      wait_for_code_bank_(1 / (2.0 * config.icache.shared_banks)),
      stream_conflicts_(config.l1.stream_conflicts),
      collisions_(config.fpu.collisions) {
  const FpuConfig& fpu = config.fpu;
  const auto mapped = [&](int units) {
    return fpu.mapping == FpuMapping::Fixed ? Pools{units, 1.0, {}}
                                            : Pools{1, static_cast<double>(units), {}};
  };
  pools_[index(Unit::Fpu)] = mapped(fpu.units);
  pools_[index(Unit::Divider)] = {1, static_cast<double>(fpu.dividers), {}};
  pools_[index(Unit::Int64)] = mapped(fpu.int64_units);
  pools_[index(Unit::Bank)] = {1, 1.0, {}};
  pools_[index(Unit::L1)] = {1, 0.0, {}};
  pools_[index(Unit::Refill)] = {1, config.icache.refills, {}};
  shared_ = {Unit::Fpu, Unit::Divider, Unit::Int64, Unit::Bank, Unit::L1, Unit::Refill};
  const auto add_queue = [&](Unit unit, int units) {
    pools_[index(unit)] = {1, static_cast<double>(units), {}};
    if (units > 0 && collisions_ > 0) queues_.push_back({unit, static_cast<double>(units), {}});
  };
  add_queue(Unit::Divider, fpu.dividers);
  for (const work::OffloadKindInfo& info : work::kOffloadKinds) {
    const int units = config.accelerators[work::index(info.kernel)].units;
    if (units == 0) continue;
    shared_.push_back(accelerator_of(info.kernel));
    add_queue(shared_.back(), units);
  }
}

void Contention::solve(const std::vector<Runner>& runners, std::vector<Progress>& progress,
                       double dma_words) {
  progress.assign(runners.size(), Progress{});
  if (runners.size() < 2 && dma_words == 0) return;
  begin(runners, dma_words);
  for (int i = 0; i < kMaxRounds; ++i) {
    ++rounds_;
    if (round(runners) < kSettled) break;
    if (scarce_.empty())
      secant_step(i == 0);
    else
      std::swap(pace_, next_pace_);
  }
  sum_up();
  book_losses(progress);
}

void Contention::begin(const std::vector<Runner>& runners, double dma_words) {
  const std::size_t n = runners.size();
  dma_words_ = dma_words;
  // What the DMA moves, up to half of what there is.
  pools_[index(Unit::L1)].capacity = std::max(banks_ - dma_words, 0.5 * banks_);
  for (std::vector<double>* of_runners : {&pace_, &rate_, &free_rate_}) of_runners->assign(n, 1.0);
  for (std::vector<double>* of_runners : {&colliding_, &queued_}) of_runners->assign(n, 0.0);
  for (std::vector<double>* of_runners :
       {&next_pace_, &change_, &last_next_pace_, &last_change_, &streamed_, &scattered_, &fetches_})
    of_runners->resize(n);
  asked_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    streamed_[i] = runners[i].streamed;
    scattered_[i] = runners[i].scattered;
    fetches_[i] = runners[i].fetches;
    asked_ |= runners[i].asks;
  }
  find_pools(runners);
  find_scarce(runners);
  for (const Unit unit : scarce_) limits_[index(unit)].assign(n, kUnlimited);
  pairs_.clear();
  if (collisions_ == 0) return;
  for (const Unit unit : {Unit::Fpu, Unit::Int64}) pair_up(runners, unit);
  for (Queue& queue : queues_) {
    queue.members.clear();
    if ((asked_ & bit(queue.unit)) == 0) continue;
    for (std::size_t i = 0; i < n; ++i) {
      const UnitDemand& asked = runners[i].units[index(queue.unit)];
      if (asked.requests > 0)
        queue.members.push_back({i, asked.requests, asked.cycles / asked.requests});
    }
    if (static_cast<double>(queue.members.size()) <= queue.units) queue.members.clear();
  }
}

void Contention::find_pools(const std::vector<Runner>& runners) {
  for (const Unit unit : {Unit::Fpu, Unit::Int64}) {
    Pools& kind = pools_[index(unit)];
    if (kind.pools < 2 || (asked_ & bit(unit)) == 0) continue;
    kind.pool_of.resize(runners.size());
    for (std::size_t i = 0; i < runners.size(); ++i) kind.pool_of[i] = runners[i].core % kind.pools;
  }
}

void Contention::pair_up(const std::vector<Runner>& runners, Unit unit) {
  const Pools& kind = pools_[index(unit)];
  if (kind.pools == 0 || kind.capacity != 1 || (asked_ & bit(unit)) == 0) return;
  for (std::size_t i = 0; i < runners.size(); ++i) {
    const UnitDemand& a = runners[i].units[index(unit)];
    if (a.cycles == 0) continue;
    for (std::size_t j = i + 1; j < runners.size(); ++j) {
      if (kind.pools > 1 && kind.pool_of[i] != kind.pool_of[j]) continue;
      const UnitDemand& b = runners[j].units[index(unit)];
      if (b.cycles == 0) continue;
      const bool by_chance = a.run == 0 || b.run == 0;
      pairs_.push_back({i, j, a.cycles, b.cycles,
                        by_chance ? 0 : collisions_in_runs(1, a.run, 1, b.run), by_chance});
    }
  }
}

/// Units that would not serve all requests at the highest rates, which are 1.
void Contention::find_scarce(const std::vector<Runner>& runners) {
  scarce_.clear();
  for (const Unit unit : shared_) {
    const Pools& kind = pools_[index(unit)];
    if (kind.pools == 0 || (asked_ & bit(unit)) == 0) continue;
    if (kind.pools == 1) {
      double demand = 0;
      for (const Runner& runner : runners) demand += runner.units[index(unit)].cycles;
      if (demand > kind.capacity) scarce_.push_back(unit);
      continue;
    }
    demand_.assign(static_cast<std::size_t>(kind.pools), 0.0);
    for (std::size_t i = 0; i < runners.size(); ++i)
      demand_[static_cast<std::size_t>(kind.pool_of[i])] += runners[i].units[index(unit)].cycles;
    if (*std::max_element(demand_.begin(), demand_.end()) > kind.capacity) scarce_.push_back(unit);
  }
}

double Contention::round(const std::vector<Runner>& runners) {
  const std::size_t n = runners.size();
  if (!pairs_.empty()) collide();
  if (scarce_.empty())
    for (std::size_t i = 0; i < n; ++i) rate_[i] = pace_[i] / (1 + colliding_[i]);
  else
    last_rate_ = rate_;
  std::fill(queued_.begin(), queued_.end(), 0.0);
  for (Queue& queue : queues_) {
    if (queue.members.empty()) continue;
    scarce_.empty() ? wait_in(queue) : wait_some_more_in(queue);
  }
  sum_up();
  for (std::size_t i = 0; i < n; ++i)
    free_rate_[i] = 1.0 / (1.0 + l1_delay(i) + fetch_delay(i) + colliding_[i] + queued_[i]);
  return scarce_.empty() ? settle() : settle_below_limits(runners);
}

/// Takes the rates as the sharing of time makes them.
double Contention::settle() {
  double largest = 0;
  for (std::size_t i = 0; i < rate_.size(); ++i) {
    rate_[i] = free_rate_[i];
    next_pace_[i] = rate_[i] * (1 + colliding_[i]);
    change_[i] = next_pace_[i] - pace_[i];
    largest = std::max(largest, std::abs(change_[i]));
  }
  return largest;
}

/// Each unit's limit is found with what the *other* limits leave of the demand.
double Contention::settle_below_limits(const std::vector<Runner>& runners) {
  const std::size_t n = runners.size();
  for (const Unit unit : scarce_) {
    for (std::size_t i = 0; i < n; ++i) rate_[i] = std::min(free_rate_[i], allowed(i, index(unit)));
    limit(index(unit), runners);
  }
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    rate_[i] = std::min(free_rate_[i], allowed(i, index(Unit::Core)));
    next_pace_[i] = rate_[i] * (1 + colliding_[i]);
    change_[i] = next_pace_[i] - pace_[i];
    largest = std::max(largest, std::abs(rate_[i] - last_rate_[i]));
  }
  return largest;
}

/// The paces of the next round.
void Contention::secant_step(bool first) {
  double along = 0;
  double curved = 0;
  for (std::size_t i = 0; !first && i < pace_.size(); ++i) {
    const double bend = change_[i] - last_change_[i];
    along += change_[i] * bend;
    curved += bend * bend;
  }
  const double back = curved > 0 ? along / curved : 0;
  for (std::size_t i = 0; i < pace_.size(); ++i) {
    const double pace =
        back == 0 ? next_pace_[i] : next_pace_[i] - back * (next_pace_[i] - last_next_pace_[i]);
    pace_[i] = pace > 0 && pace <= 1 ? pace : next_pace_[i];
  }
  std::swap(last_change_, change_);
  std::swap(last_next_pace_, next_pace_);
}

/// What runners lose by chance at units that they share, per lone cycle. What else slows a core
/// down keeps it from asking as often.
void Contention::collide() {
  std::fill(colliding_.begin(), colliding_.end(), 0.0);
  for (const Pair& pair : pairs_) {
    const double a = std::min(1.0, pair.of_a * pace_[pair.a]);
    const double b = std::min(1.0, pair.of_b * pace_[pair.b]);
    if (pair.by_chance) {
      colliding_[pair.a] += collisions_by_chance(a, b);
      colliding_[pair.b] += collisions_by_chance(b, a);
    } else {
      colliding_[pair.a] += a * b * pair.in_runs;
      colliding_[pair.b] += a * b * pair.in_runs;
    }
  }
  for (std::size_t i = 0; i < colliding_.size(); ++i) colliding_[i] *= collisions_ / pace_[i];
}

double Contention::counted_part(const Queue& queue) const {
  if (queue.units == 1) return collisions_;
  double busy = 0;  // units, on average
  for (const Queue::Member& m : queue.members) busy += m.requests * rate_[m.runner] * m.busy;
  // With several units a request waits only while all are busy, and for the first that ends.
  return collisions_ * std::pow(std::min(1.0, busy / queue.units), queue.units - 1) / queue.units;
}

/// What all requests of a queue wait behind each other. With A what of it counts, request i waits
/// w_i = A (S - s_i), where s_i is what one waits behind those of runner i (queued_behind), and S
/// the sum of these. As s_i depends on w_i, it is a rising function of S, linear up to a bound:
/// so S is the zero of a function that bends one way only, and Newton's steps from above end there.
void Contention::wait_in(Queue& queue) {
  const double counts = counted_part(queue);
  double sum = 0;
  for (Queue::Member& m : queue.members) {
    const double served = m.requests * rate_[m.runner] * m.busy;
    const double part = 1 / (1 + counts * served);
    m.most = m.busy * (1 - served / 2);
    m.constant = m.busy * served / 2 * part;
    m.slope = counts * served * part;
    sum += m.most;
  }
  for (bool bounded = true; bounded;) {
    bounded = false;
    double constant = 0;
    double slope = 0;
    for (const Queue::Member& m : queue.members) {
      const bool at_most = m.constant + m.slope * sum > m.most;
      bounded |= at_most;
      constant += at_most ? m.most : m.constant;
      slope += at_most ? 0 : m.slope;
    }
    const double next = constant / (1 - slope);
    if (!(next < sum)) break;
    sum = next;
  }
  for (Queue::Member& m : queue.members) {
    m.waiting = counts * (sum - std::min(m.most, m.constant + m.slope * sum));
    queued_[m.runner] += m.requests * m.waiting;
  }
}

/// A step towards what wait_in() finds.
void Contention::wait_some_more_in(Queue& queue) {
  const double counts = counted_part(queue);
  const auto behind = [&](const Queue::Member& m) {
    return queued_behind({m.requests * rate_[m.runner], m.busy, m.waiting});
  };
  double sum = 0;
  for (const Queue::Member& m : queue.members) sum += behind(m);
  for (Queue::Member& m : queue.members) {
    sum -= behind(m);
    m.waiting = (m.waiting + counts * sum) / 2;
    sum += behind(m);
    queued_[m.runner] += m.requests * m.waiting;
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
      if (demand.requests > 0 && (kind.pools == 1 || kind.pool_of[i] == pool))
        requests_.push_back(
            {i, demand.requests, demand.requests * rate_[i], demand.cycles / demand.requests});
    }
    apply(requests_, fair_rate(requests_, kind.capacity), limits);
  }
}

/// The rate that all kinds of units but one allow a runner.
double Contention::allowed(std::size_t runner, std::size_t except) const {
  double rate = kUnlimited;
  for (const Unit unit : scarce_)
    if (index(unit) != except) rate = std::min(rate, limits_[index(unit)][runner]);
  return rate;
}

void Contention::sum_up() {
  all_streamed_ = all_scattered_ = all_fetches_ = 0;
  for (std::size_t i = 0; i < rate_.size(); ++i) {
    all_streamed_ += streamed_[i] * rate_[i];
    all_scattered_ += scattered_[i] * rate_[i];
    all_fetches_ += fetches_[i] * rate_[i];
  }
}

double Contention::l1_delay(std::size_t i) const {
  const double scattered = all_scattered_ - scattered_[i] * rate_[i] + dma_words_;
  const double streamed = all_streamed_ - streamed_[i] * rate_[i];
  const double beside_streams = scattered + stream_conflicts_ * streamed;
  return (scattered_[i] * (scattered + streamed) + streamed_[i] * beside_streams) * wait_for_bank_;
}

double Contention::fetch_delay(std::size_t i) const {
  return fetches_[i] * (all_fetches_ - fetches_[i] * rate_[i]) * wait_for_code_bank_;
}

/// Books the time that runners lose on what they wait for.
void Contention::book_losses(std::vector<Progress>& progress) const {
  for (std::size_t i = 0; i < progress.size(); ++i) {
    progress[i].rate = rate_[i];
    CoreCycles& on = progress[i].lost;
    on[Mechanism::Banks] = rate_[i] * l1_delay(i);
    on[Mechanism::FetchContention] = rate_[i] * fetch_delay(i);
    on[Mechanism::Fpu] = rate_[i] * colliding_[i];
  }
  for (const Queue& queue : queues_)
    for (const Queue::Member& m : queue.members)
      progress[m.runner].lost[mechanism_of(queue.unit)] += rate_[m.runner] * m.requests * m.waiting;
  for (std::size_t i = 0; i < progress.size(); ++i) {
    CoreCycles& on = progress[i].lost;
    const auto tightest = std::min_element(scarce_.begin(), scarce_.end(), [&](Unit a, Unit b) {
      return limits_[index(a)][i] < limits_[index(b)][i];
    });
    const Unit unit = tightest == scarce_.end() ? Unit::Fpu : *tightest;
    on[mechanism_of(unit)] += std::max(0.0, 1.0 - rate_[i] - on.waiting());
  }
}

}  // namespace leviosim::sim
