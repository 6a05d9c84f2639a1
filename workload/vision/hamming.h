// Hamming distances of binary descriptors, with one of the two held in registers.
#pragma once

#include "sim/work/functions.h"
#include "workload/math/host_hints.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// The words of descriptors, eight each.
template <class P>
using DescriptorWords = typename P::template Span<const typename P::U32>;

/// A descriptor in registers: it is compared with many.
template <class P>
struct HeldDescriptor {
  typename P::U32 words[kDescriptorWords];
};

/// Descriptor `i` of `descriptors`, loaded.
template <class P, class Index>
HeldDescriptor<P> hold_descriptor(DescriptorWords<P> descriptors, Index i) {
  const auto from = descriptors.subspan(Index(i * Index(kDescriptorWords)), kDescriptorWords);
  HeldDescriptor<P> held;
  for (int w = 0; w < kDescriptorWords; ++w) held.words[w] = from[w];
  return held;
}

/// In how many bits `a` and descriptor `i` of `descriptors` differ.
template <class P, class Index>
typename P::I32 hamming_distance(const HeldDescriptor<P>& a, DescriptorWords<P> descriptors,
                                 Index i) {
  const auto b = descriptors.subspan(Index(i * Index(kDescriptorWords)), kDescriptorWords);
  typename P::I32 distance = 0;
  LEVIOSIM_HOST_VECTORISED
  for (int w = 0; w < kDescriptorWords; ++w)
    distance += work::popcount(a.words[w] ^ typename P::U32(b[w]));
  return distance;
}

}  // namespace leviosim::vio
