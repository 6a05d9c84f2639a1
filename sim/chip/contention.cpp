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

/// Requests of one runner to a unit: per lone cycle, and per cycle at its present rate.
struct Request {
  std::size_t runner;
  double per_lone_cycle;
  double per_cycle;
};

/// The request rate to which a unit of the given capacity (requests per cycle) holds its requesters
/// back: infinite if it serves everybody. Water filling from the smallest demand upwards.
double fair_rate(std::vector<Request>& requests, double capacity) {
  double demand = 0;
  for (const Request& r : requests) demand += r.per_cycle;
  if (demand <= capacity) return kUnlimited;
  std::sort(requests.begin(), requests.end(), [](const Request& a, const Request& b) {
    return a.per_cycle != b.per_cycle ? a.per_cycle < b.per_cycle : a.runner < b.runner;
  });
  double left = capacity;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const double share = left / static_cast<double>(requests.size() - i);
    if (requests[i].per_cycle > share) return share;
    left -= requests[i].per_cycle;
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
  return {core,
          demand.fpu_ops / cycles,
          demand.divisions / cycles,
          demand.l1_accesses / cycles,
          demand.fetches / cycles,
          demand.refills / cycles};
}

void Contention::limit_fpus(const std::vector<Runner>& runners) {
  std::fill(fpu_limit_.begin(), fpu_limit_.end(), kUnlimited);
  if (fpu_.units == 0) return;
  const bool fixed = fpu_.mapping == FpuMapping::Fixed;
  const int pools = fixed ? fpu_.units : 1;
  const double capacity = (fixed ? 1.0 : fpu_.units) / fpu_.cycles_per_op;
  std::vector<Request> requests;
  for (int pool = 0; pool < pools; ++pool) {
    requests.clear();
    for (std::size_t i = 0; i < runners.size(); ++i)
      if (runners[i].fpu > 0 && runners[i].core % pools == pool)
        requests.push_back({i, runners[i].fpu, runners[i].fpu * rate_[i]});
    apply(requests, fair_rate(requests, capacity), fpu_limit_);
  }
}

void Contention::limit(const std::vector<Runner>& runners, double Runner::*requests,
                       double capacity, std::vector<double>& limits) const {
  std::fill(limits.begin(), limits.end(), kUnlimited);
  std::vector<Request> all;
  for (std::size_t i = 0; i < runners.size(); ++i)
    if (runners[i].*requests > 0)
      all.push_back({i, runners[i].*requests, runners[i].*requests * rate_[i]});
  if (!all.empty()) apply(all, fair_rate(all, capacity), limits);
}

double Contention::bank_delay(const std::vector<Runner>& runners, double Runner::*accesses,
                              int banks, std::size_t i) const {
  double others = 0;
  for (std::size_t j = 0; j < runners.size(); ++j)
    if (j != i) others += runners[j].*accesses * rate_[j];
  return runners[i].*accesses * others / (2.0 * banks);
}

void Contention::solve(const std::vector<Runner>& runners, std::vector<Progress>& progress) {
  const std::size_t n = runners.size();
  rate_.assign(n, 1.0);
  fpu_limit_.assign(n, kUnlimited);
  div_limit_.assign(n, kUnlimited);
  refill_limit_.assign(n, kUnlimited);
  progress.assign(n, Progress{});
  if (n < 2) return;

  const auto l1_delay = [&](std::size_t i) {
    return bank_delay(runners, &Runner::accesses, banks_, i);
  };
  const auto fetch_delay = [&](std::size_t i) {
    return bank_delay(runners, &Runner::fetches, code_.shared_banks, i);
  };
  std::vector<double> free_rate(n);  // without units that serve in turn
  // Each unit's limit is found with what the *other* limits leave of the demand.
  const auto leave = [&](const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t i = 0; i < n; ++i) rate_[i] = std::min({free_rate[i], a[i], b[i]});
  };
  for (int round = 0; round < kMaxRounds; ++round) {
    double change = 0;
    for (std::size_t i = 0; i < n; ++i) free_rate[i] = 1.0 / (1.0 + l1_delay(i) + fetch_delay(i));
    leave(div_limit_, refill_limit_);
    limit_fpus(runners);
    leave(fpu_limit_, refill_limit_);
    limit(runners, &Runner::divisions, fpu_.dividers / fpu_.cycles_per_division, div_limit_);
    leave(fpu_limit_, div_limit_);
    limit(runners, &Runner::refills, code_.refills / code_.shared_miss, refill_limit_);
    for (std::size_t i = 0; i < n; ++i) {
      const double rate = std::min({free_rate[i], fpu_limit_[i], div_limit_[i], refill_limit_[i]});
      change = std::max(change, std::abs(rate - progress[i].rate));
      rate_[i] = progress[i].rate = rate;
    }
    if (change < kSettled) break;
  }
  for (std::size_t i = 0; i < n; ++i) {
    Progress& p = progress[i];
    p.banks = p.rate * l1_delay(i);
    p.fetch = p.rate * fetch_delay(i);
    const double lost = std::max(0.0, 1.0 - p.rate - p.banks - p.fetch);
    const double tightest = std::min({fpu_limit_[i], div_limit_[i], refill_limit_[i]});
    (tightest == fpu_limit_[i] ? p.fpu : tightest == div_limit_[i] ? p.divider : p.fetch) += lost;
  }
}

}  // namespace leviosim::sim
