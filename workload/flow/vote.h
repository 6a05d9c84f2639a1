// One displacement from those of many blocks: each axis has a histogram over half pixels, its
// fullest bin wins, and the mean over the bins within a pixel of it is the flow. Blocks on
// something that moves otherwise, or matched wrongly, fall elsewhere.
//
// Fixed point, because not all chips have floating-point units: 1/256 px.
#pragma once

#include "sim/work/policy.h"
#include "workload/flow/options.h"

namespace leviosim::flow {

inline constexpr int kFractionBits = 8;
/// Bins to either side of the fullest that take part in the mean: one pixel.
inline constexpr int kVoteRadius = 2;

/// Of one axis; bins for -(2 search + 1) … 2 search + 1 half pixels.
template <class P>
class Histogram {
  using I = typename P::I32;

 public:
  explicit Histogram(int search) : zero_(2 * search + 1) {
    for (int bin : P::range(0, bins())) count_[bin] = I(0);
  }

  void add(I half_pixels) {
    const I bin = half_pixels + I(zero_);
    count_[bin] = I(count_[bin]) + I(1);
  }

  /// The flow in 1/256 px, rounded down; the first of equally full bins wins. At least one
  /// displacement has been added.
  I flow() {
    I fullest = 0;
    I most = 0;
    for (int bin : P::range(0, bins())) {
      const I n = count_[bin];
      if (n > most) {
        most = n;
        fullest = bin;
      }
    }
    const int begin = work::value(work::max(I(0), I(fullest - I(kVoteRadius))));
    const int end = work::value(work::min(I(bins()), I(fullest + I(kVoteRadius + 1))));
    I sum = 0;
    I number = 0;
    for (int bin : P::range(begin, end)) {
      const I n = count_[bin];
      sum += n * I(bin);
      number += n;
    }
    // Bins are half pixels, hence one bit less; they are not negative, so the quotient is exact
    // in its rounding.
    return (sum << (kFractionBits - 1)) / number - (I(zero_) << (kFractionBits - 1));
  }

 private:
  static constexpr int kMostBins = 2 * (2 * Options::kLargestSearch + 1) + 1;
  int bins() const { return 2 * zero_ + 1; }

  int zero_;  ///< the bin of no displacement
  typename P::template Array<I, kMostBins> count_;
};

}  // namespace leviosim::flow
