// How fast cores progress while they share units: a fluid model, solved anew whenever the set of
// running segments changes (design section 4).
//
// A core's rate is the share of each cycle in which it progresses as if it were alone: 1 without
// contention. A shared unit serves requests in turn (round robin by request, hw_facts 3.2: four
// cores dividing in single and four in half precision take 4·14 + 4·10 cycles a round), so when its
// demand exceeds its capacity, the requesters that are held back get equal request rates and the
// others all they ask for. L1 banks add a small delay to each access instead: with requesters j
// making p_j accesses per cycle on B interleaved banks, an access waits Σ p_j / (2B) cycles
// (hw_facts 4.1). The banks of the shared instruction cache delay private misses in the same way,
// and its refills from L2 are served in turn like divisions.
//
// Left out: transients of a few cycles until requesters have interleaved, and the alignment of
// lock-step accesses to particular banks.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/cost.h"

namespace leviosim::sim {

/// What slows a core down while it runs beside others, per cycle of its running time.
struct Progress {
  double rate = 1;     ///< cycles of lone progress per cycle
  double fpu = 0;      ///< share of the time lost to floating-point units
  double divider = 0;  ///< … to the divider
  double banks = 0;    ///< … to L1 bank conflicts
  double fetch = 0;    ///< … to the shared instruction cache and its refills
};

/// One running segment as the solver sees it.
struct Runner {
  int core = 0;          ///< id, decides the floating-point unit under a fixed mapping
  double fpu = 0;        ///< floating-point operations per lone cycle
  double divisions = 0;  ///< divisions per lone cycle
  double accesses = 0;   ///< L1 accesses per lone cycle
  double fetches = 0;    ///< lines from the shared instruction cache per lone cycle
  double refills = 0;    ///< lines from L2 per lone cycle

  static Runner of(int core, const Demand& demand);
};

/// Solves the rates of all runners at once. Results are in the order of the runners.
class Contention {
 public:
  explicit Contention(const ClusterConfig& config)
      : fpu_(config.fpu), code_(config.icache), banks_(config.l1.banks) {}

  void solve(const std::vector<Runner>& runners, std::vector<Progress>& progress);

 private:
  void limit_fpus(const std::vector<Runner>& runners);
  /// Limits of units that serve everybody in turn.
  void limit(const std::vector<Runner>& runners, double Runner::*requests, double capacity,
             std::vector<double>& limits) const;
  /// Cycles per lone cycle that runner i waits for banks that others use at the same time.
  double bank_delay(const std::vector<Runner>& runners, double Runner::*accesses, int banks,
                    std::size_t i) const;

  FpuConfig fpu_;
  InstructionCacheConfig code_;
  int banks_;
  std::vector<double> rate_;          ///< current estimate
  std::vector<double> fpu_limit_;     ///< highest rate that the floating-point units allow
  std::vector<double> div_limit_;     ///< … the dividers
  std::vector<double> refill_limit_;  ///< … the refills of the shared instruction cache
};

}  // namespace leviosim::sim
