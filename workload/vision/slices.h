// Closing the gaps between the per-core slices of a list, as the master core does after a fork in
// which every core appended to a slice of its own.
#pragma once

#include "sim/work/machine.h"

namespace leviosim::vio {

/// The slice of core `id` begins at element share_of(items, id, cores).begin * per_item and holds
/// kept[id] elements. Calls move(to, from) for every element that has to move, in an order that
/// allows moving within one list.
/// @param moved  whether there is a gap before the first slice, too
/// @return the number of elements of all slices
template <class P, class Move>
int compact_slices(int items, int per_item, typename P::template Span<const typename P::I32> kept,
                   Move&& move, bool moved = false) {
  int total = 0;
  for (int id : P::range(0, kept.size())) {
    const int begin = work::share_of(items, id, kept.size()).begin * per_item;
    const int count = work::value(typename P::I32(kept[id]));
    if (id > 0 || moved)
      for (int i : P::range(0, count)) move(total + i, begin + i);
    total += count;
  }
  return total;
}

}  // namespace leviosim::vio
