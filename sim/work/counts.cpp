#include "sim/work/counts.h"

#include <utility>

#include "sim/work/op.h"

namespace leviosim::work {

std::span<const OpInfo> op_list() { return kOps; }

Counts settled(const RawCounts& raw) {
  Counts taken{raw.n, {}, {}};
  for (const Op op : {Op::LoadStream, Op::LoadIndexed, Op::StoreStream, Op::StoreIndexed,
                      Op::LoadL2, Op::StoreL2, Op::LoadShared, Op::StoreShared}) {
    taken[Op::Straddle] += taken[op] >> 32;
    taken[op] &= 0xffffffffu;
  }
  taken[Op::BranchTaken] -= raw.not_taken_after_all;
  taken[Op::BranchNotTaken] -= taken[Op::BranchTaken];
  return taken;
}

Counts take_tally() {
  Counts taken = settled({tally.n, std::exchange(branches_not_taken_after_all, 0)});
  taken.code = tally.code;
  taken.compiled = tally.compiled;
  tally = Counts{};
  return taken;
}

}  // namespace leviosim::work
