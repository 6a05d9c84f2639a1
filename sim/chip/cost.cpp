#include "sim/chip/cost.h"

#include <algorithm>
#include <numeric>

#include "sim/chip/work_sum.h"
#include "sim/work/op.h"

namespace leviosim::sim {
namespace {

using work::Compiled;
using work::Op;

/// That an operation's stall cycles are booked on.
Mechanism stall_mechanism(Op op) {
  switch (op) {
    case Op::BranchTaken:
    case Op::BranchNotTaken:
    case Op::LoopEntry:
    case Op::LoopIteration:
    case Op::LoopJump:
    case Op::Call:
    case Op::JumpRegister:
      return Mechanism::Control;
    case Op::LoadStream:
    case Op::LoadIndexed:
    case Op::StoreStream:
    case Op::StoreIndexed:
    case Op::LoadL2:
    case Op::StoreL2:
    case Op::LoadShared:
    case Op::StoreShared:
    case Op::Straddle:
      return Mechanism::Memory;
    default:
      return Mechanism::Arithmetic;
  }
}

bool repeats_loops(Op op) { return op == Op::LoopIteration || op == Op::LoopJump; }

double part_of(const work::CompiledWork& work, Compiled part) {
  return static_cast<double>(work[static_cast<std::size_t>(part)]);
}

double ratio_of_all(const work::CompiledWork& work) {
  return work::compiled_ratio(work, Compiled::Executed, Compiled::Priced, 1);
}

double ratio_of_loops(const work::CompiledWork& work) {
  return work::compiled_ratio(work, Compiled::ExecutedLoops, Compiled::PricedLoops,
                              ratio_of_all(work));
}

/// Of what does not repeat loops.
double ratio_of_others(const work::CompiledWork& work) {
  const double priced = part_of(work, Compiled::Priced) - part_of(work, Compiled::PricedLoops);
  const double executed =
      part_of(work, Compiled::Executed) - part_of(work, Compiled::ExecutedLoops);
  return priced > 0 && executed > 0 ? executed / priced : ratio_of_all(work);
}

}  // namespace

std::array<OpCost, work::kOpCount> default_costs() {
  std::array<OpCost, work::kOpCount> costs{};
  costs[work::index(Op::IntAddShift)].issue = 2;  // a sum and a shift
  return costs;
}

namespace {

/// The ratios of one segment's compiled code.
class CompiledRatios {
 public:
  CompiledRatios(const work::Counts& segment, work::CompiledFor code)
      : CompiledRatios(work::compiled_of(segment.compiled, code)) {}

  /// @param repeats  whether they repeat loops
  OperationsOfKind apply(bool repeats, double count) const {
    const double emitted = count * (repeats ? emitted_loops_ : emitted_);
    return {.count = count,
            .stalled = measured_ && repeats ? emitted : count,
            .emitted = measured_ ? emitted : 0,
            .unmeasured = measured_ ? 0 : count,
            .used_at_once = count * used_at_once_};
  }

 private:
  explicit CompiledRatios(const work::CompiledWork& work)
      : measured_(is_measured(work)),
        emitted_loops_(ratio_of_loops(work)),
        emitted_(ratio_of_others(work)),
        // Not of the loads: compiled code may execute fewer or more than were counted.
        used_at_once_(work::compiled_ratio(work, Compiled::LoadsUsedAtOnce, Compiled::Priced, 0)) {}

  bool measured_;
  double emitted_loops_;  ///< of what repeats loops
  double emitted_;        ///< of all else
  double used_at_once_;   ///< loads, for each counted instruction
};

/// Cycles that operations of one kind cost a core that runs alone.
struct OperationCost {
  double issue;
  double load_use;
  double stall;
  Mechanism stall_mechanism;

  void add_to(LoneCycles& cycles) const {
    cycles[Mechanism::Issue] += issue;
    cycles[Mechanism::LoadUse] += load_use;
    cycles[stall_mechanism] += stall;
  }
};

OperationCost cost_of(const CoreCosts::Price& price, const OperationsOfKind& operations,
                      const CoreCosts& core) {
  // A routine was counted with its moves and spills.
  const double issued = price.routine ? operations.count
                                      : operations.emitted * core.measured_instructions +
                                            operations.unmeasured * core.unmeasured_instructions;
  // In measured code, the instruction behind a load waits: any one.
  double used_at_once = price.routine ? 0 : operations.used_at_once * price.issue;
  if (price.loads) used_at_once += operations.unmeasured * core.load_use_fraction;
  return {price.issue * issued, core.load_use_stall * used_at_once,
          operations.stalled * price.stall, price.stall_mechanism};
}

/// An iteration of a loop has its operations in a row, behind the loads of what they need.
double run_of(double requests, std::uint64_t iterations) {
  return iterations == 0 ? 0 : std::max(1.0, requests / static_cast<double>(iterations));
}

}  // namespace

CoreCosts::CoreCosts(const CoreConfig& core)
    : code(core.code),
      measured_instructions(core.measured_instructions),
      unmeasured_instructions(core.unmeasured_instructions),
      load_use_fraction(core.load_use_fraction),
      load_use_stall(core.load_use_stall) {
  for (const work::OpInfo& info : work::kOps) {
    const OpCost& cost = core[info.op];
    prices_[work::index(info.op)] = {cost.issue,
                                     cost.stall,
                                     cost.busy,
                                     stall_mechanism(info.op),
                                     cost.unit,
                                     cost.routine,
                                     repeats_loops(info.op),
                                     info.op == Op::LoadStream || info.op == Op::LoadIndexed};
  }
}

Demand demand_of(const work::Counts& counts, const CoreCosts& core, const CodeFetcher& code,
                 OperationAccounts* by_operation) {
  Demand demand;
  const CompiledRatios ratios(counts, core.code);
  for (std::size_t op = 0; op < work::kOpCount; ++op) {
    if (counts.n[op] == 0) continue;  // as most are in a short segment
    const CoreCosts::Price& price = core[op];
    const auto n = static_cast<double>(counts.n[op]);
    const OperationCost alone = cost_of(price, ratios.apply(price.repeats, n), core);
    alone.add_to(demand.alone);
    if (by_operation != nullptr) {
      OperationAccount& account = (*by_operation)[op];
      account.count += n;
      alone.add_to(account.cycles);
    }
    if (price.unit == Unit::Core) continue;
    UnitDemand& unit = demand.units[static_cast<std::size_t>(price.unit)];
    unit.requests += n;
    unit.cycles += n * price.busy;
  }
  const CodeFetch fetch = code.fetch(counts.code);
  const double lines = code.lines_executed(demand.alone[Mechanism::Issue]);
  demand.alone[Mechanism::Fetch] = fetch.stall + code.wait_for_lines(lines, fetch);
  if (by_operation != nullptr) {
    OperationAccount& account = (*by_operation)[kCodeOperation];
    account.count += std::accumulate(counts.code.begin(), counts.code.end(), 0.0);
    account.cycles[Mechanism::Fetch] += demand.alone[Mechanism::Fetch];
  }
  demand.fetches = fetch.requests + lines;
  demand.units[static_cast<std::size_t>(Unit::Refill)] = {fetch.refills, fetch.refill_cycles};
  for (UnitDemand& unit : demand.units) unit.run = run_of(unit.requests, counts[Op::LoopIteration]);
  const auto sum = [&](auto... ops) { return (static_cast<double>(counts[ops]) + ...); };
  // The second half of a straddling access follows the first.
  demand.streamed = sum(Op::LoadStream, Op::StoreStream, Op::Straddle);
  demand.scattered = sum(Op::LoadIndexed, Op::StoreIndexed);
  return demand;
}

void WorkSum::add(const work::Counts& segment, work::CompiledFor code) {
  const CompiledRatios ratios(segment, code);
  for (std::size_t i = 0; i < work::kOpCount; ++i)
    if (segment.n[i] > 0)
      kinds_[i] += ratios.apply(repeats_loops(work::kOps[i].op), static_cast<double>(segment.n[i]));
}

WorkSum& WorkSum::operator+=(const WorkSum& other) {
  for (std::size_t i = 0; i < work::kOpCount; ++i) kinds_[i] += other.kinds_[i];
  return *this;
}

LoneCycles WorkSum::cost(const CoreCosts& core) const {
  LoneCycles cycles;
  for (std::size_t i = 0; i < work::kOpCount; ++i) cost_of(core[i], kinds_[i], core).add_to(cycles);
  return cycles;
}

}  // namespace leviosim::sim
