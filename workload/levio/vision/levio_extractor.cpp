#include "workload/levio/vision/levio_extractor.h"

#include <algorithm>

#include "sim/base/check.h"
#include "workload/levio/vision/corner_tests.h"
#include "workload/levio/vision/levio_blur.h"
#include "workload/levio/vision/levio_descriptor.h"
#include "workload/levio/vision/offset_tables.h"
#include "workload/vision/extraction_steps.h"
#include "workload/vision/host_kernels.h"

namespace leviosim::vio::levio {
namespace {

/// Offers every corner of the box to `best`.
template <class P>
void detect_in_box(ConstImageView<P> image, const PixelBox<P>& box, const OffsetTables<P>& tables,
                   const ExtractorOptions& options, BestOfCell<P>& best) {
  using I = typename P::I32;
  const I fast_threshold = options.fast_threshold;
  const I harris_threshold = options.harris_threshold;
  const typename P::OffloadRegion kernel(
      work::OffloadKind::Corners,
      (work::value(box.x1) - work::value(box.x0)) * (work::value(box.y1) - work::value(box.y0)));
  for (int y : P::range(box.y0, box.y1))
    for (int x : P::range(box.x0, box.x1)) {
      const int centre = y * image.width + x;
      const typename P::Bool corner =
          is_corner_at<P>(image, centre, options.fast_threshold, [&]() LEVIOSIM_HOST_INLINED {
            return is_corner<P>(image.pixels, centre, tables, fast_threshold);
          });
      if (work::unlikely(corner)) {
        const I score = response_at<P>(image, centre, [&]() LEVIOSIM_HOST_INLINED {
          return corner_response<P>(image.pixels, image.width, centre, tables);
        });
        if (score > harris_threshold) best.offer(x, y, score);
      }
    }
}

/// The fork "detect": every core fills a slice of the list, the master closes the gaps.
template <class P>
void detect_all(work::Machine& machine, ConstImageView<P> image, const OffsetTables<P>& tables,
                typename P::template Span<typename P::I32> kept, const ExtractorOptions& options,
                FeatureList<P>& out) {
  using I = typename P::I32;
  using U16 = typename P::U16;
  const int columns = options.cells_along(image.width);
  const int cells = columns * options.cells_along(image.height);
  machine.fork("detect", [&](work::Core& core) {
    const auto [begin, end] = core.share(cells);
    const int slice = begin * options.per_cell;
    I found = 0;
    for (int c : P::range(begin, end)) {
      const I row = I(c) / I(columns);
      const I column = I(c) - row * I(columns);
      const int place = slice + work::value(found);
      const int room = end * options.per_cell - place;
      BestOfCell<P> best(out.x.subspan(place, room), out.y.subspan(place, room), options.per_cell);
      detect_in_box<P>(image, box_of_cell<P>(image, options, column, row), tables, options, best);
      found += best.count();
    }
    kept[core.id] = found;
  });
  out.count = compact_slices<P>(cells, options.per_cell, kept, [&](int to, int from) {
    out.x[to] = work::narrow<U16>(I(out.x[from]));
    out.y[to] = work::narrow<U16>(I(out.y[from]));
  });
}

constexpr host::DiscMask kWindowDisc = host::make_disc_mask(kSquaredDiscRadius);

/// The fork "describe", in slices of ceil(n / cores).
template <class P, class Kind>
void describe_all(work::Machine& machine, ConstImageView<P> blurred, FeatureList<P>& out) {
  using I = typename P::I32;
  using U = typename P::U32;
  const typename P::template Span<const U> pattern(Kind::template pattern<P>().data(), kPairs);
  machine.fork("describe", [&](work::Core& core) {
    const int each = (out.count + core.cores - 1) / core.cores;
    for (int i :
         P::range(std::min(out.count, core.id * each), std::min(out.count, (core.id + 1) * each))) {
      const I at = I(out.y[i]) * I(blurred.width) + I(out.x[i]);
      // The windows around it are streams from a computed place.
      const int centre = work::value(at);
      const Moments<P> moments =
          moments_at<P>(kWindowDisc, blurred, centre, [&]() LEVIOSIM_HOST_INLINED {
            return levio::disc_moments<P>(blurred.pixels, blurred.width, centre);
          });
      describe<P, Kind>(blurred.pixels, blurred.width, centre, direction_of<P>(moments), pattern,
                        out.descriptors.subspan(kDescriptorWords * i, kDescriptorWords));
    }
  });
}

}  // namespace

template <class P>
void extract_features(work::Machine& machine, ImageView<P> image_in_l2,
                      const ExtractorOptions& options, DescriptorKind kind, FeatureList<P>& out) {
  using Bytes = typename P::template Span<typename P::Byte>;
  options.validate();
  const int width = image_in_l2.width, height = image_in_l2.height;
  check(out.capacity >= options.max_features(width, height),
        "the feature list has room for every feature of the image");
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);
  const ImageView<P> image{memory.alloc<Bytes>("image", width * height), width, height};
  const ImageView<P> blurred{memory.alloc<Bytes>("blurred image", width * height), width, height};
  const auto kept = memory.alloc<typename P::template Span<typename P::I32>>("keypoints per core",
                                                                             machine.cores());
  const OffsetTables<P> tables(memory, width);
  machine.copy_in(image.pixels, image_in_l2.pixels);
  detect_all<P>(machine, image, tables, kept, options, out);
  machine.fork("blur", [&](work::Core& core) {
    const auto [begin, end] = core.share(height);
    levio::blur_rows<P>(image, blurred, begin, end);
  });
  if (kind == DescriptorKind::Released)
    describe_all<P, ReleasedDescriptor>(machine, blurred, out);
  else
    describe_all<P, ExactDescriptor>(machine, blurred, out);
  // Last, because descriptors are of whole pixels.
  if (options.subpixel_steps > 1) refine_keypoints<P>(machine, image, options, {0, out.count}, out);
}

template void extract_features(work::Machine&, ImageView<work::Native>, const ExtractorOptions&,
                               DescriptorKind, FeatureList<work::Native>&);
template void extract_features(work::Machine&, ImageView<work::Counting>, const ExtractorOptions&,
                               DescriptorKind, FeatureList<work::Counting>&);

}  // namespace leviosim::vio::levio
