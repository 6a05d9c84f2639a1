// The kernel of the example.
#pragma once

#include "sim/work/policy.h"

namespace exposure {

using namespace leviosim;

// [kernel]
/// Sum of the grey levels of a row.
template <class P>
typename P::I32 row_sum(typename P::template Span<const typename P::Byte> row) {
  using I = typename P::I32;
  const typename P::Function function("exposure_row_sum");
  I sum = 0;
  for (int x : P::range(0, row.size())) sum += I(row[x]);
  return sum;
}
// [/kernel]

}  // namespace exposure
