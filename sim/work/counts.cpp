#include "sim/work/counts.h"

#include <utility>

namespace leviosim::work {

Counts take_tally() {
  Counts taken = tally;
  tally = Counts{};
  for (const Op op : {Op::LoadStream, Op::LoadIndexed, Op::StoreStream, Op::StoreIndexed,
                      Op::LoadL2, Op::StoreL2, Op::LoadShared, Op::StoreShared}) {
    taken[Op::Straddle] += taken[op] >> 32;
    taken[op] &= 0xffffffffu;
  }
  taken[Op::BranchTaken] -= std::exchange(branches_not_taken_after_all, 0);
  taken[Op::BranchNotTaken] -= taken[Op::BranchTaken];
  return taken;
}

}  // namespace leviosim::work
