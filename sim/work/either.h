// Blocks that lie in local memory, or where that has no room for them in the memory behind
// (Machine::set_behind), from where a core of the team reads and writes them at the price of L2.
// For lists that are needed at random, or by the way: what is walked over passes in tiles
// (tiles.h).
#pragma once

#include <string_view>

#include "sim/work/machine.h"

namespace leviosim::work {

template <class P, class T>
typename P::template EitherSpan<T> alloc_either(Machine& machine, std::string_view name, int n) {
  using Span = typename P::template Span<T>;
  const Bytes size(static_cast<std::int64_t>(sizeof(T)) * n);
  if (machine.has_room(size)) return machine.local().alloc<Span>(name, n);
  return typename P::template EitherSpan<T>(machine.behind().alloc<Span>(name, n)).in_l2();
}

/// Frees what was allocated in either memory during its life.
class EitherFrame {
 public:
  explicit EitherFrame(Machine& machine) : local_(machine.local()), behind_(machine.behind()) {}

 private:
  Arena::Frame local_, behind_;
};

}  // namespace leviosim::work
