// Hamming distances of binary descriptors, with one of the two held in registers.
#pragma once

#include <bit>
#include <cstdint>

#include "sim/work/functions.h"
#include "workload/math/host_value.h"
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

/// In how many bits `a` differs from the descriptor at `words`, as it suits the host.
template <class P, class Word>
LEVIOSIM_HOST_INLINE typename P::I32 hamming_distance_on_host(const HeldDescriptor<P>& a,
                                                              const Word* words) {
  const auto two_words = [](const auto* from) {
    return std::uint64_t{work::value(from[0])} | std::uint64_t{work::value(from[1])} << 32;
  };
  std::int32_t distance = 0;
  for (int w = 0; w < kDescriptorWords; w += 2)
    distance += std::popcount(two_words(a.words + w) ^ two_words(words + w));
  return distance;
}

/// In how many bits `a` and descriptor `i` of `descriptors` differ.
/// @tparam Words  a span of them, in whatever memory
template <class P, class Words, class Index>
LEVIOSIM_HOST_INLINE typename P::I32 hamming_distance(const HeldDescriptor<P>& a,
                                                      const Words& descriptors, Index i) {
  const auto b = descriptors.subspan(Index(i * Index(kDescriptorWords)), kDescriptorWords);
  return host_value(
      [&] {
        typename P::I32 distance = 0;
        for (int w = 0; w < kDescriptorWords; ++w)
          distance += work::popcount(a.words[w] ^ typename P::U32(b[w]));
        return distance;
      },
      [&] { return hamming_distance_on_host(a, b.data()); });
}

}  // namespace leviosim::vio
