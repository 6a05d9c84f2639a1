#include "sim/work/counts.h"

namespace leviosim::work {

Counts take_tally() {
  Counts taken = tally;
  tally = Counts{};
  for (const Op op : {Op::LoadStream, Op::LoadIndexed, Op::StoreStream, Op::StoreIndexed,
                      Op::LoadL2, Op::StoreL2, Op::LoadShared, Op::StoreShared}) {
    taken[Op::Straddle] += taken[op] >> 32;
    taken[op] &= 0xffffffffu;
  }
  taken[Op::BranchNotTaken] -= taken[Op::BranchTaken];
  return taken;
}

}  // namespace leviosim::work
