#include "workload/vision/matcher.h"

#include "workload/vision/two_way_matching.h"

namespace leviosim::vio {
namespace {

struct Comparison {
  static constexpr work::CodeName kFunction{"search_matches"};
  template <class P>
  LEVIOSIM_HOST_INLINE static typename P::I32 distance(const HeldDescriptor<P>& held,
                                                       DescriptorWords<P> reference, int r) {
    return hamming_distance<P>(held, reference, r);
  }
};

}  // namespace

template <class P>
void match_sources(work::Machine& machine, const DescriptorSource<P>& current,
                   const DescriptorSource<P>& reference, const MatcherOptions& options,
                   MatchList<P>& out) {
  two_way::match<P, Comparison>(machine, current, reference, options, out);
}

template void match_sources(work::Machine&, const DescriptorSource<work::Native>&,
                            const DescriptorSource<work::Native>&, const MatcherOptions&,
                            MatchList<work::Native>&);
template void match_sources(work::Machine&, const DescriptorSource<work::Counting>&,
                            const DescriptorSource<work::Counting>&, const MatcherOptions&,
                            MatchList<work::Counting>&);

}  // namespace leviosim::vio
