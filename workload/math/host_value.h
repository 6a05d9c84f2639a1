// A value that the host computes in a way of its own, while the work of the target's way is
// counted.
//
//   const auto corner = host_value(
//       [&]() LEVIOSIM_HOST_INLINED { return is_corner<P>(…); },  // counted, and the target's way
//       [&] { return host::is_corner(…); });                      // what the host computes
//
// Nothing uses the value of the counted way. So the host's compiler removes its arithmetic and
// keeps its counters, which it adds up over loops as far as they do not depend on data. It has to
// inline the counted way for that (LEVIOSIM_HOST_INLINE, LEVIOSIM_HOST_INLINED). Worth it for whole
// numbers whose way on the target is long. Debug builds compute both and compare.
#pragma once

#include <cstring>
#include <type_traits>

#include "sim/base/check.h"
#include "workload/math/compilers.h"

namespace leviosim {

/// What `quick` returns, which has the bits of what `counted` returns. The target runs `counted`.
template <class Counted, class Quick>
LEVIOSIM_HOST_INLINE auto host_value(Counted&& counted, [[maybe_unused]] Quick&& quick) {
#if LEVIOSIM_HOST_SHORTCUTS
  using Value = decltype(counted());
  static_assert(std::has_unique_object_representations_v<Value>);
  [[maybe_unused]] const Value value = counted();
  const Value same = quick();
#ifndef NDEBUG
  check(std::memcmp(&value, &same, sizeof value) == 0, "the host's way gives the counted value");
#endif
  return same;
#else
  return counted();
#endif
}

}  // namespace leviosim
