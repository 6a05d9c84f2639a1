#include "sim/chip/instruction_cache.h"

#include <algorithm>
#include <cmath>

namespace leviosim::sim {
namespace {

// Substituting u = (1 - g)^(n-1), which is uniform; the midpoint rule is exact enough.
constexpr int kSteps = 64;
using Shares = std::array<double, kSteps>;

/// The shares g of the loop since one of n cores used a line, at the middle of each step of u.
Shares shares_since_use(int n) {
  Shares shares{};
  if (n == 1) return shares;
  for (int i = 0; i < kSteps; ++i)
    shares[static_cast<std::size_t>(i)] = 1 - std::pow((i + 0.5) / kSteps, 1.0 / (n - 1));
  return shares;
}

/// Share of lines that survive, of n cores in the same loop: the mean of exp(-x n g) over the share
/// g. For one core g is 1.
double survival(double x, int n, const Shares& shares) {
  if (n == 1) return std::exp(-x);
  double sum = 0;
  for (const double g : shares) sum += std::exp(-x * n * g);
  return sum / kSteps;
}

/// Reuse distance that stands for a class: the middle of it on a logarithmic scale.
double distance_of(std::size_t k) {
  const auto end = static_cast<double>(work::kReuseClassEnds[k]);
  return k == 0 ? end : std::sqrt(end * work::kReuseClassEnds[k - 1]);
}

double miss_share_of_class(std::size_t k, Bytes cache, int sharers) {
  if (k == work::kNeverFetched) return 1.0 / sharers;  // one of them fetches it for all
  if (cache == Bytes(0)) return 1;
  return miss_share(distance_of(k) / static_cast<double>(cache.count()), sharers);
}

}  // namespace

double miss_share(double reuse, int sharers) {
  if (reuse <= 1) return 0;
  // m = 1 - survival(m·reuse) has one root above 0. Starting from 1, m decreases towards it.
  const Shares shares = shares_since_use(sharers);
  double misses = 1;
  for (int round = 0; round < 1000; ++round) {
    const double next = 1 - survival(misses * reuse, sharers, shares);
    if (misses - next < 1e-6) break;
    misses = next;
  }
  return misses;
}

CodeFetcher::CodeFetcher(const InstructionCacheConfig& config, Bytes own, int sharers)
    : shared_miss_(config.shared_miss) {
  if (config.line == Bytes(0)) return;
  const auto line = static_cast<double>(config.line.count());
  for (std::size_t k = 0; k < work::kReuseClasses; ++k) {
    const double requests = k == work::kNeverFetched ? 1 : miss_share_of_class(k, own, 1);
    const double refills = std::min(requests, miss_share_of_class(k, config.shared, sharers));
    PerByte& cost = per_byte_[k];
    cost.requests = own == Bytes(0) ? 0 : requests / line;
    cost.refills = refills / line;
    cost.stall = (requests - refills) / line * (own == Bytes(0) ? 0 : config.shared_hit) +
                 refills / line * config.shared_miss;
  }
}

CodeFetch CodeFetcher::fetch(const work::CodeReuse& code) const {
  CodeFetch sum;
  for (std::size_t k = 0; k < work::kReuseClasses; ++k) {
    const auto bytes = static_cast<double>(code[k]);
    sum.stall += bytes * per_byte_[k].stall;
    sum.requests += bytes * per_byte_[k].requests;
    sum.refills += bytes * per_byte_[k].refills;
  }
  sum.refill_cycles = sum.refills * shared_miss_;
  return sum;
}

}  // namespace leviosim::sim
