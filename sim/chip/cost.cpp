#include "sim/chip/cost.h"

namespace leviosim::sim {
namespace {

using work::Op;

/// The account that an operation's stall cycles are booked on.
double CycleBreakdown::*stall_account(Op op) {
  switch (op) {
    case Op::BranchTaken:
    case Op::BranchNotTaken:
    case Op::LoopEntry:
    case Op::LoopIteration:
    case Op::Call:
      return &CycleBreakdown::control;
    case Op::LoadStream:
    case Op::LoadIndexed:
    case Op::StoreStream:
    case Op::StoreIndexed:
    case Op::LoadL2:
    case Op::StoreL2:
    case Op::Straddle:
      return &CycleBreakdown::memory;
    default:
      return &CycleBreakdown::arithmetic;
  }
}

}  // namespace

CycleBreakdown& CycleBreakdown::operator+=(const CycleBreakdown& o) {
  issue += o.issue;
  load_use += o.load_use;
  control += o.control;
  memory += o.memory;
  arithmetic += o.arithmetic;
  fetch += o.fetch;
  return *this;
}

CycleBreakdown operator*(const CycleBreakdown& b, double k) {
  return {b.issue * k, b.load_use * k, b.control * k, b.memory * k, b.arithmetic * k, b.fetch * k};
}

Demand price(const work::Counts& counts, const CoreConfig& core, const CodeFetcher& code) {
  Demand demand;
  for (const work::OpInfo& info : work::kOps) {
    const auto n = static_cast<double>(counts[info.op]);
    const OpCost& cost = core[info.op];
    demand.alone.issue += n * cost.issue * core.instruction_overhead;
    demand.alone.*stall_account(info.op) += n * cost.stall;
    if (cost.unit == Unit::Fpu) demand.fpu_ops += n;
    if (cost.unit == Unit::Divider) demand.divisions += n;
  }
  const auto sum = [&](auto... ops) { return (static_cast<double>(counts[ops]) + ...); };
  const double loads = sum(Op::LoadStream, Op::LoadIndexed);
  demand.alone.load_use = loads * core.load_use_fraction * core.load_use_stall;
  const CodeFetch fetch = code.fetch(counts.code);
  demand.alone.fetch = fetch.stall;
  demand.fetches = fetch.requests;
  demand.refills = fetch.refills;
  demand.l1_accesses = loads + sum(Op::StoreStream, Op::StoreIndexed, Op::Straddle);
  return demand;
}

}  // namespace leviosim::sim
