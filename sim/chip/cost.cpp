#include "sim/chip/cost.h"

namespace leviosim::sim {
namespace {

using work::Op;

/// The breakdown that an operation's stall cycles are booked on.
double UsefulCycles::*stall_breakdown(Op op) {
  switch (op) {
    case Op::BranchTaken:
    case Op::BranchNotTaken:
    case Op::LoopEntry:
    case Op::LoopIteration:
    case Op::LoopJump:
    case Op::Call:
    case Op::JumpRegister:
      return &UsefulCycles::control;
    case Op::LoadStream:
    case Op::LoadIndexed:
    case Op::StoreStream:
    case Op::StoreIndexed:
    case Op::LoadL2:
    case Op::StoreL2:
    case Op::LoadShared:
    case Op::StoreShared:
    case Op::Straddle:
      return &UsefulCycles::memory;
    default:
      return &UsefulCycles::arithmetic;
  }
}

}  // namespace

UsefulCycles& UsefulCycles::operator+=(const UsefulCycles& o) {
  issue += o.issue;
  load_use += o.load_use;
  control += o.control;
  memory += o.memory;
  arithmetic += o.arithmetic;
  fetch += o.fetch;
  accelerator += o.accelerator;
  return *this;
}

UsefulCycles operator*(const UsefulCycles& b, double k) {
  return {b.issue * k,      b.load_use * k, b.control * k,    b.memory * k,
          b.arithmetic * k, b.fetch * k,    b.accelerator * k};
}

Demand price(const work::Counts& counts, const CoreConfig& core, const CodeFetcher& code) {
  using work::Compiled;
  Demand demand;
  const double emitted =
      core.instruction_overhead *
      work::compiled_ratio(counts.compiled, Compiled::Executed, Compiled::Priced, 1);
  for (const work::OpInfo& info : work::kOps) {
    const auto n = static_cast<double>(counts[info.op]);
    const OpCost& cost = core[info.op];
    // A routine was counted with its moves and spills.
    demand.alone.issue += n * cost.issue * (cost.routine ? 1.0 : emitted);
    demand.alone.*stall_breakdown(info.op) += n * cost.stall;
    if (cost.unit == Unit::Core) continue;
    UnitDemand& unit = demand.units[static_cast<std::size_t>(cost.unit)];
    unit.requests += n;
    unit.cycles += n * cost.busy;
  }
  const auto sum = [&](auto... ops) { return (static_cast<double>(counts[ops]) + ...); };
  const double loads = sum(Op::LoadStream, Op::LoadIndexed);
  const double used_at_once = work::compiled_ratio(counts.compiled, Compiled::LoadsUsedAtOnce,
                                                   Compiled::Loads, core.load_use_fraction);
  demand.alone.load_use = loads * used_at_once * core.load_use_stall;
  const CodeFetch fetch = code.fetch(counts.code);
  demand.alone.fetch = fetch.stall;
  demand.fetches = fetch.requests + code.lines_executed(demand.alone.issue);
  demand.units[static_cast<std::size_t>(Unit::Refill)] = {fetch.refills, fetch.refill_cycles};
  // The second half of a straddling access follows the first.
  demand.streamed = sum(Op::LoadStream, Op::StoreStream, Op::Straddle);
  demand.scattered = sum(Op::LoadIndexed, Op::StoreIndexed);
  return demand;
}

}  // namespace leviosim::sim
