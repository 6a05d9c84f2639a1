#include "workload/vision/extractor.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/check.h"
#include "sim/error.h"
#include "workload/vision/blur.h"
#include "workload/vision/cell_detector.h"
#include "workload/vision/descriptor.h"
#include "workload/vision/slices.h"
#include "workload/vision/subpixel.h"

namespace leviosim::vio {

int ExtractorOptions::cells_along(int side) const {
  return std::max(0, side - 2 * border + cell - 1) / cell;
}

int ExtractorOptions::max_features(int width, int height) const {
  return cells_along(width) * cells_along(height) * per_cell;
}

void ExtractorOptions::validate() const {
  const auto require = [](bool ok, const char* option, int value, const std::string& expected) {
    if (!ok)
      throw InputError(
          fmt::format("feature extraction: {} is {}, expected {}", option, value, expected));
  };
  require(border >= kDescriptorReach, "border", border,
          fmt::format("at least {} px, the reach of a descriptor", kDescriptorReach));
  require(cell >= 1, "cell", cell, "at least 1 px");
  require(per_cell >= 1 && per_cell <= kMostPerCell, "per_cell", per_cell,
          fmt::format("1 to {}", kMostPerCell));
  require(subpixel_steps >= 1 && subpixel_steps <= 64, "subpixel_steps", subpixel_steps,
          "1 to 64, so that a coordinate fits 16 bits");
  require(fast_threshold >= 0 && fast_threshold <= 255, "fast_threshold", fast_threshold,
          "0 to 255 grey levels");
}

namespace {

/// The stage's local memory besides the features: 38 400 bytes of images and about 300 of tables at
/// 160 × 120 px.
template <class P>
struct Workspace {
  using I = typename P::I32;
  using Bytes = typename P::template Span<typename P::Byte>;
  using Table = typename P::template Span<I>;

  Workspace(work::Arena& arena, int width, int height, int cores)
      : image{arena.alloc<Bytes>("image", width * height), width, height},
        blurred{arena.alloc<Bytes>("blurred image", width * height), width, height},
        ring_offsets(arena.alloc<Table>("FAST ring offsets", kRingSize)),
        blur_kernel(arena.alloc<Table>("blur kernel", kBlurTaps)),
        disc(arena.alloc<Table>("disc half-widths", kDiscRows)),
        kept(arena.alloc<Table>("keypoints per core", cores)) {}

  ImageView<P> image, blurred;
  Table ring_offsets, blur_kernel, disc, kept;
};

/// A constant of the program image, seen by the cluster.
template <class P, class Constant>
auto in_l2(const Constant& constant) {
  using Element = const typename Constant::value_type;
  return typename P::template L2Span<Element>(constant.data(), static_cast<int>(constant.size()));
}

template <class P>
void load(work::Machine& machine, ImageView<P> image_in_l2, Workspace<P>& work) {
  machine.copy_in(work.image.pixels, image_in_l2.pixels);
  machine.copy_in(work.blur_kernel, in_l2<P>(kBlurKernel<P>));
  machine.copy_in(work.disc, in_l2<P>(kDiscHalfWidths<P>));
  fill_ring_offsets<P>(work.image.width, work.ring_offsets);
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

/// Fills this core's slice of the keypoint list from its share of the cells.
/// @return the number of keypoints found
template <class P>
typename P::I32 detect(const Workspace<P>& work, const ExtractorOptions& options, work::Share cells,
                       const FeatureList<P>& out) {
  using I = typename P::I32;
  const ConstImageView<P> image = work.image;
  const I cells_per_row = options.cells_along(image.width);
  const int slice = cells.begin * options.per_cell;
  const int room = (cells.end - cells.begin) * options.per_cell;
  I found = 0;
  for (int c : P::range(cells.begin, cells.end)) {
    const I row = I(c) / cells_per_row;
    const I column = I(c) - row * cells_per_row;
    const int end_of_slice = work::value(found);
    BestOfCell<P> best(out.x.subspan(slice + end_of_slice, room - end_of_slice),
                       out.y.subspan(slice + end_of_slice, room - end_of_slice), options.per_cell);
    detect_in_box<P>(image, box_of_cell<P>(image, options, column, row), work.ring_offsets, options,
                     best);
    found += best.count();
  }
  return found;
}

template <class P>
void detect_all(work::Machine& machine, Workspace<P>& work, const ExtractorOptions& options,
                FeatureList<P>& out) {
  const int cells = options.cells_along(work.image.width) * options.cells_along(work.image.height);
  machine.fork("detect", [&](work::Core& core) {
    work.kept[core.id] = detect<P>(work, options, core.share(cells), out);
  });
  using I = typename P::I32;
  using U16 = typename P::U16;
  out.count = compact_slices<P>(cells, options.per_cell, work.kept, [&](int to, int from) {
    out.x[to] = work::narrow<U16>(I(out.x[from]));
    out.y[to] = work::narrow<U16>(I(out.y[from]));
  });
}

template <class P, class Pattern>
void describe_all(work::Machine& machine, const Workspace<P>& work, Pattern pattern,
                  FeatureList<P>& out) {
  using I = typename P::I32;
  const ConstImageView<P> image = work.blurred;
  machine.fork("describe", [&](work::Core& core) {
    const auto [begin, end] = core.share(out.count);
    for (int i : P::range(begin, end)) {
      const I column = out.x[i];
      const I row = out.y[i];
      const int centre = work::value(I(row * I(image.width) + column));
      const Moments<P> moments = disc_moments<P>(image.pixels, image.width, centre, work.disc);
      describe<P>(image.pixels, image.width, centre, direction_of<P>(moments), pattern,
                  out.descriptors.subspan(kDescriptorWords * i, kDescriptorWords));
    }
  });
}

}  // namespace

template <class P>
void extract_features(work::Machine& machine, ImageView<P> image_in_l2,
                      const ExtractorOptions& options, FeatureList<P>& out) {
  options.validate();
  check(out.capacity >= options.max_features(image_in_l2.width, image_in_l2.height),
        "the feature list has room for every feature of the image");
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);
  Workspace<P> work(memory, image_in_l2.width, image_in_l2.height, machine.cores());
  load<P>(machine, image_in_l2, work);

  detect_all<P>(machine, work, options, out);

  machine.fork("blur", [&](work::Core& core) {
    const auto [begin, end] = core.share(work.image.height);
    blur_rows<P>(work.image, work.blurred.pixels, begin, end, work.blur_kernel);
  });

  const auto pattern_in_l2 = in_l2<P>(kPairPattern<P>);
  if (options.pattern_in_local_memory) {
    const auto pattern =
        memory.alloc<typename P::template Span<typename P::U32>>("pair pattern", kPairs);
    machine.copy_in(pattern, pattern_in_l2);
    describe_all<P>(machine, work, pattern, out);
  } else {
    describe_all<P>(machine, work, pattern_in_l2, out);
  }
  // Last, because descriptors are of whole pixels.
  if (options.subpixel_steps > 1)
    refine_keypoints<P>(machine, work.image, options.subpixel_steps, out);
}

template void extract_features<work::Native>(work::Machine&, ImageView<work::Native>,
                                             const ExtractorOptions&, FeatureList<work::Native>&);
template void extract_features<work::Counting>(work::Machine&, ImageView<work::Counting>,
                                               const ExtractorOptions&,
                                               FeatureList<work::Counting>&);

}  // namespace leviosim::vio
