// What a segment of counted work costs a core that runs alone, and what it asks of shared units.
//
// Models: issue slots of an in-order single-issue core, load-use and taken-branch stalls,
// latencies, instruction-cache refills. Leaves out: the order of instructions within a work
// segment.
#pragma once

#include "sim/chip/account.h"
#include "sim/chip/config.h"
#include "sim/chip/instruction_cache.h"
#include "sim/work/counts.h"

namespace leviosim::sim {

/// What a segment asks of one kind of shared unit.
struct UnitDemand {
  double requests = 0;
  double cycles = 0;  ///< of occupation, over all requests
  double run = 0;     ///< requests in a row, on average; 0: in any order
};

/// Demands of one segment.
struct Demand {
  LoneCycles alone;
  std::array<UnitDemand, kUnitCount> units;  ///< by Unit; none of Unit::Core
  double streamed = 0;                       ///< accesses of local memory by streams
  double scattered = 0;                      ///< … at addresses that are computed from data
  double fetches = 0;                        ///< lines of code from the shared instruction cache

  double cycles() const { return alone.total(); }
};

/// Operations of one kind, with what their segments' compiled code makes of them.
struct OperationsOfKind {
  double count = 0;
  double stalled = 0;       ///< that stall: of loops that a compiler writes out, those left
  double emitted = 0;       ///< of measured code, times executed to counted instructions
  double unmeasured = 0;    ///< of code that was not measured
  double used_at_once = 0;  ///< loads whose value the next instruction needs, for each
                            ///< instruction that the operation is priced at

  OperationsOfKind& operator+=(const OperationsOfKind& o) {
    count += o.count;
    stalled += o.stalled;
    emitted += o.emitted;
    unmeasured += o.unmeasured;
    used_at_once += o.used_at_once;
    return *this;
  }
};

/// Whether any of the functions that work visits was measured as compiled code.
inline bool is_measured(const work::CompiledWork& work) {
  return work[static_cast<std::size_t>(work::Compiled::Priced)] > 0;
}

/// What a core's configuration says of operations, in the form that pricing many segments reads.
class CoreCosts {
 public:
  CoreCosts(const CoreConfig& core);

  struct Price {
    double issue;
    double stall;
    double busy;
    Mechanism stall_mechanism;
    Unit unit;
    bool routine;
    bool repeats;  ///< it is of what repeats loops
    bool loads;    ///< the next instruction may use the value, in code that was not measured
  };
  const Price& operator[](std::size_t op) const { return prices_[op]; }

  work::CompiledFor code;
  double measured_instructions;
  double unmeasured_instructions;
  double load_use_fraction;
  double load_use_stall;

 private:
  std::array<Price, work::kOpCount> prices_;
};

/// @param code  the caches through which the core fetches; by default unlimited ones
/// @param by_operation  gets what of `alone` each kind of operation has; may be null
Demand demand_of(const work::Counts& counts, const CoreCosts& core, const CodeFetcher& code = {},
                 OperationAccounts* by_operation = nullptr);

}  // namespace leviosim::sim
