// Corners of one cell of the detection grid: every pixel is tested with FAST, corners are scored by
// Harris, and the cell keeps its best few in an array whose weakest element is replaced
// (PARAMETERS.md#feature-extraction). The cells spread the features over the image.
#pragma once

#include "workload/vision/extractor.h"
#include "workload/vision/fast.h"
#include "workload/vision/harris.h"
#include "workload/vision/host_kernels.h"

namespace leviosim::vio {

/// The best keypoints of a cell, written to `x`, `y` from their beginning in no particular order.
template <class P>
class BestOfCell {
  using I = typename P::I32;
  using U16 = typename P::U16;
  using Coordinates = typename P::template EitherSpan<U16>;

 public:
  BestOfCell(Coordinates x, Coordinates y, int capacity) : x_(x), y_(y), capacity_(capacity) {}

  /// Takes a keypoint if there is room, or in place of the weakest one if it is stronger.
  void offer(int x, int y, I score) {
    if (count_ < capacity_) {
      put(count_, x, y, score);
      count_ += I(1);
      return;
    }
    I weakest = 0;
    I weakest_score = scores_[0];
    for (int i : P::range(1, work::value(capacity_))) {
      const I candidate = scores_[i];
      if (candidate < weakest_score) {
        weakest_score = candidate;
        weakest = i;
      }
    }
    if (score > weakest_score) put(weakest, x, y, score);
  }

  I count() const { return count_; }

 private:
  void put(I slot, int x, int y, I score) {
    x_[slot] = work::narrow<U16>(I(x));
    y_[slot] = work::narrow<U16>(I(y));
    scores_[slot] = score;
  }

  Coordinates x_, y_;
  I capacity_;
  I count_ = 0;
  typename P::template Array<I, ExtractorOptions::kMostPerCell> scores_;
};

/// Pixels [x0, x1) × [y0, y1).
template <class P>
struct PixelBox {
  typename P::I32 x0, y0, x1, y1;
};

/// Offers every corner of the box to `best`.
template <class P>
void detect_in_box(ConstImageView<P> image, const PixelBox<P>& box,
                   typename P::template Span<const typename P::I32> ring_offsets,
                   const ExtractorOptions& options, BestOfCell<P>& best) {
  using I = typename P::I32;
  const I fast_threshold = options.fast_threshold;
  const I harris_threshold = options.harris_threshold;
  const typename P::OffloadRegion kernel(
      work::OffloadKind::Corners,
      (work::value(box.x1) - work::value(box.x0)) * (work::value(box.y1) - work::value(box.y0)));
  for (int y : P::range(box.y0, box.y1))
    for (int x : P::range(box.x0, box.x1)) {
      const int row = y - image.top;
      const int centre = row * image.width + x;
      const typename P::Bool corner =
          is_corner_at<P>(image, centre, options.fast_threshold, [&]() LEVIOSIM_HOST_INLINED {
            return is_fast_corner<P>(image.pixels, centre, ring_offsets, fast_threshold);
          });
      if (work::unlikely(corner)) {
        const I score = response_at<P>(image, centre, [&]() LEVIOSIM_HOST_INLINED {
          return harris_response<P>(image.pixels, image.width, x, row);
        });
        if (score > harris_threshold) best.offer(x, y, score);
      }
    }
}

}  // namespace leviosim::vio
