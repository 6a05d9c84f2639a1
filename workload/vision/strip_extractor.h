// Feature extraction from images that do not fit in local memory: the same features, bit by bit, as
// extract_features() finds, from strips of rows that pass through two buffers.
//
// Four passes over strips of whole rows of cells, each with the forks of the whole image: "detect",
// "blur" (whose result goes back to L2), "describe", and "refine" if there are corners between
// pixels. What the strips share with their neighbours is read again by the DMA rather than kept.
#pragma once

#include <algorithm>
#include <array>

#include "sim/work/machine.h"
#include "workload/vision/extractor.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// @param image_in_l2    8-bit image
/// @param blurred_in_l2  room for its blurred copy, of the same size
/// @param out            as for extract_features()
/// @throws InputError if not even one row of cells fits in local memory
template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                FeatureList<P>& out);

// An image in L2 that is larger than the local memory, read in strips of rows: two buffers, of
// which the DMA fills one while the cores work on the other.

/// Rows [begin, end) to work on, for which rows [top, bottom) are read.
struct Strip {
  int begin, end;
  int top, bottom;
};

/// Rows [begin, end) of an image of `height` rows in strips of `rows`, the last may have fewer; for
/// every one `reach` rows more are read above and below, as far as the image has them.
class StripPlan {
 public:
  StripPlan(int begin, int end, int rows, int reach, int height)
      : begin_(begin), end_(end), rows_(rows), reach_(reach), height_(height) {}

  int count() const { return (end_ - begin_ + rows_ - 1) / rows_; }
  Strip operator[](int i) const {
    const int begin = begin_ + i * rows_;
    const int end = std::min(begin + rows_, end_);
    return {begin, end, std::max(0, begin - reach_), std::min(height_, end + reach_)};
  }
  /// Rows that a buffer must hold.
  int most_rows() const { return std::min(height_, rows_ + 2 * reach_); }

 private:
  int begin_, end_, rows_, reach_, height_;
};

/// Calls work(i, strip, rows) for every strip of `image_in_l2`, where `rows` is a view of the rows
/// that were read. Local memory: two buffers.
template <class P, class Work>
void for_each_strip(work::Machine& machine, ConstImageView<P> image_in_l2, const StripPlan& plan,
                    Work&& work) {
  using Byte = typename P::Byte;
  using Pixels = typename P::template Span<Byte>;
  const work::Arena::Frame memory(machine.local());
  const int width = image_in_l2.width;
  std::array<Pixels, 2> buffers;
  for (Pixels& buffer : buffers)
    buffer = machine.local().template alloc<Pixels>("image strip", plan.most_rows() * width);

  const auto fetch = [&](int i) {
    const Strip strip = plan[i];
    const int pixels = (strip.bottom - strip.top) * width;
    return machine.start_copy_in(buffers[static_cast<std::size_t>(i % 2)].subspan(0, pixels),
                                 image_in_l2.pixels.subspan(strip.top * width, pixels));
  };
  work::Machine::Ticket under_way = fetch(0);
  for (int i : P::range(0, plan.count())) {
    machine.wait(under_way);
    if (i + 1 < plan.count()) under_way = fetch(i + 1);
    const Strip strip = plan[i];
    work(i, strip,
         ConstImageView<P>{buffers[static_cast<std::size_t>(i % 2)], width, image_in_l2.height,
                           strip.top});
  }
}

}  // namespace leviosim::vio
