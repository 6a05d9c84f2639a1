#include "sim/chip/contention.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leviosim::sim {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// The limits of one unit depend on the rates that the others allow. A few rounds settle it; the
// bound only keeps a pathological mix from going on for ever.
constexpr int kMaxRounds = 16;
constexpr double kSettled = 1e-9;

constexpr std::array kShared = {Unit::Fpu, Unit::Divider, Unit::Int64};

constexpr std::size_t index(Unit unit) { return static_cast<std::size_t>(unit); }

/// Requests of one runner to a unit: per lone cycle, and per cycle at its present rate.
struct Request {
  std::size_t runner;
  double per_lone_cycle;
  double per_cycle;
  double busy;  ///< cycles that one of them occupies the unit, on average
};

/// The request rate to which units of the given number hold their requesters back: infinite if they
/// serve everybody. Water filling from the smallest demand upwards.
double fair_rate(std::vector<Request>& requests, double units) {
  double demand = 0;
  double busy = 0;  // of one request of everybody who is not served yet
  for (const Request& r : requests) {
    demand += r.per_cycle * r.busy;
    busy += r.busy;
  }
  if (demand <= units) return kUnlimited;
  std::sort(requests.begin(), requests.end(), [](const Request& a, const Request& b) {
    return a.per_cycle != b.per_cycle ? a.per_cycle < b.per_cycle : a.runner < b.runner;
  });
  double left = units;
  for (const Request& r : requests) {
    const double share = left / busy;
    if (r.per_cycle > share) return share;
    left -= r.per_cycle * r.busy;
    busy -= r.busy;
  }
  return kUnlimited;
}

void apply(const std::vector<Request>& requests, double fair, std::vector<double>& limits) {
  if (fair == kUnlimited) return;
  for (const Request& r : requests)
    limits[r.runner] = std::min(limits[r.runner], fair / r.per_lone_cycle);
}

}  // namespace

Runner Runner::of(int core, const Demand& demand) {
  const double cycles = std::max(demand.cycles(), 1.0);
  Runner runner{core, demand.units, demand.l1_accesses / cycles};
  for (UnitDemand& unit : runner.units) {
    unit.requests /= cycles;
    unit.cycles /= cycles;
  }
  return runner;
}

Contention::Contention(const FpuConfig& fpu, const L1Config& l1) : banks_(l1.banks) {
  const auto mapped = [&](int units) {
    return fpu.mapping == FpuMapping::Fixed ? Pools{units, 1.0}
                                            : Pools{1, static_cast<double>(units)};
  };
  pools_[index(Unit::Fpu)] = mapped(fpu.units);
  pools_[index(Unit::Divider)] = {1, static_cast<double>(fpu.dividers)};
  pools_[index(Unit::Int64)] = mapped(fpu.int64_units);
}

/// Finds the highest rates that the units of one kind allow at the present rates.
void Contention::limit(std::size_t unit, const std::vector<Runner>& runners) {
  std::vector<double>& limits = limits_[unit];
  limits.assign(runners.size(), kUnlimited);
  const Pools& kind = pools_[unit];
  std::vector<Request> requests;
  for (int pool = 0; pool < kind.pools; ++pool) {
    requests.clear();
    for (std::size_t i = 0; i < runners.size(); ++i) {
      const UnitDemand& demand = runners[i].units[unit];
      if (demand.requests > 0 && runners[i].core % kind.pools == pool)
        requests.push_back(
            {i, demand.requests, demand.requests * rate_[i], demand.cycles / demand.requests});
    }
    apply(requests, fair_rate(requests, kind.capacity), limits);
  }
}

/// The rate that all kinds of units but one allow a runner.
double Contention::allowed(std::size_t runner, std::size_t except) const {
  double rate = kUnlimited;
  for (std::size_t unit = 0; unit < kUnitCount; ++unit)
    if (unit != except) rate = std::min(rate, limits_[unit][runner]);
  return rate;
}

double Contention::bank_delay(const std::vector<Runner>& runners, std::size_t i) const {
  double others = 0;
  for (std::size_t j = 0; j < runners.size(); ++j)
    if (j != i) others += runners[j].accesses * rate_[j];
  return runners[i].accesses * others / (2.0 * banks_);
}

void Contention::solve(const std::vector<Runner>& runners, std::vector<Progress>& progress) {
  const std::size_t n = runners.size();
  rate_.assign(n, 1.0);
  for (std::vector<double>& limits : limits_) limits.assign(n, kUnlimited);
  progress.assign(n, Progress{});
  if (n < 2) return;

  std::vector<double> free_rate(n);  // without shared arithmetic units
  for (int round = 0; round < kMaxRounds; ++round) {
    double change = 0;
    for (std::size_t i = 0; i < n; ++i) free_rate[i] = 1.0 / (1.0 + bank_delay(runners, i));
    // Each unit's limit is found with what the *other* limits leave of the demand.
    for (const Unit unit : kShared) {
      for (std::size_t i = 0; i < n; ++i)
        rate_[i] = std::min(free_rate[i], allowed(i, index(unit)));
      limit(index(unit), runners);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double rate = std::min(free_rate[i], allowed(i, index(Unit::Core)));
      change = std::max(change, std::abs(rate - progress[i].rate));
      rate_[i] = progress[i].rate = rate;
    }
    if (change < kSettled) break;
  }
  for (std::size_t i = 0; i < n; ++i) {
    Progress& p = progress[i];
    p.banks = p.rate * bank_delay(runners, i);
    const double lost = std::max(0.0, 1.0 - p.rate - p.banks);
    const bool by_divider = limits_[index(Unit::Divider)][i] < allowed(i, index(Unit::Divider));
    (by_divider ? p.divider : p.fpu) = lost;
  }
}

}  // namespace leviosim::sim
