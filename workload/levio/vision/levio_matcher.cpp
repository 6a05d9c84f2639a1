#include "workload/levio/vision/levio_matcher.h"

#include "workload/math/compilers.h"
#include "workload/math/target_compiler.h"
#include "workload/vision/two_way_matching.h"

namespace leviosim::vio::levio {
namespace {

struct ByteComparison {
  static constexpr work::CodeName kFunction{"levio_search_matches"};
  template <class P>
  LEVIOSIM_HOST_INLINE static typename P::I32 distance(const HeldDescriptor<P>& held,
                                                       DescriptorWords<P> reference, int r) {
    using I = typename P::I32;
    const auto words = reference.subspan(kDescriptorWords * r, kDescriptorWords);
    return host_value(
        [&] {
          I sum = 0;
          for (int w = 0; w < kDescriptorWords; ++w) {
            sum = work::copied(I(sum + work::popcount(held.words[w] ^ typename P::U32(words[w]))));
            LEVIOSIM_TARGET_BYTE(sum);
          }
          return sum;
        },
        [&] { return hamming_distance_on_host(held, words.data()); });
  }
};

}  // namespace

template <class P>
void match_sources(work::Machine& machine, const DescriptorSource<P>& current,
                   const DescriptorSource<P>& reference, const MatcherOptions& options,
                   MatchList<P>& out) {
  two_way::match<P, ByteComparison>(machine, current, reference, options, out);
}

template void match_sources(work::Machine&, const DescriptorSource<work::Native>&,
                            const DescriptorSource<work::Native>&, const MatcherOptions&,
                            MatchList<work::Native>&);
template void match_sources(work::Machine&, const DescriptorSource<work::Counting>&,
                            const DescriptorSource<work::Counting>&, const MatcherOptions&,
                            MatchList<work::Counting>&);

}  // namespace leviosim::vio::levio
