// The steps of feature extraction on images that lie, wholly or in part, in local memory: what
// extractor.cpp does for whole images and strip_extractor.cpp for strips of rows.
#pragma once

#include "workload/vision/blur.h"
#include "workload/vision/cell_detector.h"
#include "workload/vision/descriptor.h"
#include "workload/vision/slices.h"
#include "workload/vision/subpixel.h"

namespace leviosim::vio {

/// Small tables, some 300 bytes.
template <class P>
struct ExtractionTables {
  using I = typename P::I32;
  using Table = typename P::template Span<I>;

  ExtractionTables(work::Arena& arena, int cores)
      : ring_offsets(arena.alloc<Table>("FAST ring offsets", kRingSize)),
        blur_kernel(arena.alloc<Table>("blur kernel", kBlurTaps)),
        disc(arena.alloc<Table>("disc half-widths", kDiscRows)),
        kept(arena.alloc<Table>("keypoints per core", cores)) {}

  static constexpr int kIntegers = kRingSize + kBlurTaps + kDiscRows;  ///< and one per core

  Table ring_offsets, blur_kernel, disc, kept;
};

/// A constant of the program image, seen by the cluster.
template <class P, class Constant>
auto in_l2(const Constant& constant) {
  using Element = const typename Constant::value_type;
  return typename P::template L2Span<Element>(constant.data(), static_cast<int>(constant.size()));
}

template <class P>
void load_tables(work::Machine& machine, int image_width, ExtractionTables<P>& tables) {
  machine.copy_in(tables.blur_kernel, in_l2<P>(kBlurKernel<P>));
  machine.copy_in(tables.disc, in_l2<P>(kDiscHalfWidths<P>));
  fill_ring_offsets<P>(image_width, tables.ring_offsets);
}

/// The pixels of cell (column, row) of the grid.
template <class P>
PixelBox<P> box_of_cell(ConstImageView<P> image, const ExtractorOptions& options,
                        typename P::I32 column, typename P::I32 row) {
  using I = typename P::I32;
  const I side = options.cell;
  const I x0 = column * side + I(options.border);
  const I y0 = row * side + I(options.border);
  const I x1 = work::min(I(x0 + side), I(image.width - options.border));
  const I y1 = work::min(I(y0 + side), I(image.height - options.border));
  return {x0, y0, x1, y1};
}

/// Writes the keypoints of the cells [cells.begin, cells.end) to `x`, `y`, which have room for all.
/// @return their number
template <class P>
typename P::I32 detect(ConstImageView<P> image, const ExtractionTables<P>& tables,
                       const ExtractorOptions& options, work::Share cells,
                       typename P::template EitherSpan<typename P::U16> x,
                       typename P::template EitherSpan<typename P::U16> y) {
  using I = typename P::I32;
  const I cells_per_row = options.cells_along(image.width);
  I found = 0;
  for (int c : P::range(cells.begin, cells.end)) {
    const I row = I(c) / cells_per_row;
    const I column = I(c) - row * cells_per_row;
    const int room = x.size() - work::value(found);
    BestOfCell<P> best(x.subspan(found, room), y.subspan(found, room), options.per_cell);
    detect_in_box<P>(image, box_of_cell<P>(image, options, column, row), tables.ring_offsets,
                     options, best);
    found += best.count();
  }
  return found;
}

/// Appends the keypoints of the cells [cells.begin, cells.end) to `out`, in the order of the cells.
/// The fork "detect": every core fills a slice of the list, the master closes the gaps.
template <class P>
void detect_all(work::Machine& machine, ConstImageView<P> image, ExtractionTables<P>& tables,
                const ExtractorOptions& options, work::Share cells, FeatureList<P>& out) {
  const int first = out.count;
  const int number = cells.end - cells.begin;
  machine.fork("detect", [&](work::Core& core) {
    const auto [begin, end] = core.share(number);
    const int slice = first + begin * options.per_cell;
    const int room = (end - begin) * options.per_cell;
    tables.kept[core.id] =
        detect<P>(image, tables, options, {cells.begin + begin, cells.begin + end},
                  out.x.subspan(slice, room), out.y.subspan(slice, room));
  });
  using I = typename P::I32;
  using U16 = typename P::U16;
  out.count += compact_slices<P>(number, options.per_cell, tables.kept, [&](int to, int from) {
    out.x[first + to] = work::narrow<U16>(I(out.x[first + from]));
    out.y[first + to] = work::narrow<U16>(I(out.y[first + from]));
  });
}

inline constexpr host::DiscMask kDisc = host::make_disc_mask(kDiscRadius * kDiscRadius + 1);

/// Writes the descriptors of the features [features.begin, features.end) of the list to `words`,
/// the first of them to the first place: the fork "describe".
template <class P, class Pattern>
void describe_all(work::Machine& machine, ConstImageView<P> blurred,
                  const ExtractionTables<P>& tables, Pattern pattern, work::Share features,
                  const FeatureList<P>& list, typename P::template Span<typename P::U32> words) {
  using I = typename P::I32;
  const int rows_above = blurred.top * blurred.width;
  machine.fork("describe", [&](work::Core& core) {
    const auto [begin, end] = core.share(features.end - features.begin);
    for (int i : P::range(features.begin + begin, features.begin + end)) {
      const I column = list.x[i];
      const I row = list.y[i];
      // The windows around it are streams from a computed place.
      const int centre = work::value(I(row * I(blurred.width) + column)) - rows_above;
      const Moments<P> moments = moments_at<P>(kDisc, blurred, centre, [&]() LEVIOSIM_HOST_INLINED {
        return disc_moments<P>(blurred.pixels, blurred.width, centre, tables.disc);
      });
      describe<P, RotatedPoints>(
          blurred.pixels, blurred.width, centre, direction_of<P>(moments), pattern,
          words.subspan(kDescriptorWords * (i - features.begin), kDescriptorWords));
    }
  });
}

/// Calls describe(pattern) with the pattern of point pairs where `options` wants it to lie.
template <class P, class Describe>
void with_pattern(work::Machine& machine, const ExtractorOptions& options, Describe&& describe) {
  const auto in_program = in_l2<P>(kPairPattern<P>);
  if (!options.pattern_in_local_memory) return describe(in_program);
  const auto copy =
      machine.local().alloc<typename P::template Span<typename P::U32>>("pair pattern", kPairs);
  machine.copy_in(copy, in_program);
  describe(copy);
}

}  // namespace leviosim::vio
