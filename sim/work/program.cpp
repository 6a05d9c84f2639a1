#include "sim/work/program.h"

#include <cmath>

#include "sim/work/op.h"

namespace leviosim::work {
namespace {

double local_accesses(const Counts& counts) {
  return static_cast<double>(counts[Op::LoadStream] + counts[Op::LoadIndexed] +
                             counts[Op::StoreStream] + counts[Op::StoreIndexed]);
}

/// Multiplied by a factor, rounded down: what parts of a segment have, the segment has too.
void scale_straddles(Counts& counts, double factor) {
  counts[Op::Straddle] =
      static_cast<std::uint64_t>(std::floor(static_cast<double>(counts[Op::Straddle]) * factor));
}

}  // namespace

Segment shares_on_one_core(const Fork& fork) {
  Segment sum;
  for (const Segment& share : fork.shares) sum += share;
  const Counts& first = fork.shares.front();
  const double accesses = local_accesses(first);
  if (accesses == 0 || sum[Op::Straddle] == 0) return sum;
  const double in_first = fork.aligned_on_one_core ? 0 : static_cast<double>(first[Op::Straddle]);
  const double wanted = in_first * local_accesses(sum) / accesses;
  const double factor = wanted / static_cast<double>(sum[Op::Straddle]);
  for (OffloadWork& calls : sum.offload) scale_straddles(calls.counts, factor);
  sum[Op::Straddle] = static_cast<std::uint64_t>(std::llround(wanted));
  return sum;
}

}  // namespace leviosim::work
