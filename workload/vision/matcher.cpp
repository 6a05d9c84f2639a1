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
void match_two_way(work::Machine& machine, DescriptorWords<P> current, int current_count,
                   DescriptorWords<P> reference, int reference_count, const MatcherOptions& options,
                   MatchList<P>& out) {
  two_way::match<P, Comparison>(machine, current, current_count, reference, reference_count,
                                options, out);
}

template void match_two_way<work::Native>(work::Machine&, DescriptorWords<work::Native>, int,
                                          DescriptorWords<work::Native>, int, const MatcherOptions&,
                                          MatchList<work::Native>&);
template void match_two_way<work::Counting>(work::Machine&, DescriptorWords<work::Counting>, int,
                                            DescriptorWords<work::Counting>, int,
                                            const MatcherOptions&, MatchList<work::Counting>&);

}  // namespace leviosim::vio
