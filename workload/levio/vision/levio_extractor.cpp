#include "workload/levio/vision/levio_extractor.h"

#include <algorithm>

#include "sim/base/check.h"
#include "workload/levio/vision/corner_tests.h"
#include "workload/levio/vision/levio_blur.h"
#include "workload/levio/vision/levio_descriptor.h"
#include "workload/levio/vision/offset_tables.h"
#include "workload/vision/extraction_steps.h"
#include "workload/vision/host_kernels.h"
#include "workload/vision/strip_extractor.h"

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
      const int centre = (y - image.top) * image.width + x;
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

/// Appends the keypoints of these cells to the list. The fork "detect": every core fills a slice of
/// it, the master closes the gaps.
template <class P>
void detect_all(work::Machine& machine, ConstImageView<P> image, const OffsetTables<P>& tables,
                typename P::template Span<typename P::I32> kept, const ExtractorOptions& options,
                work::Share cells, FeatureList<P>& out) {
  using I = typename P::I32;
  using U16 = typename P::U16;
  const int columns = options.cells_along(image.width);
  const int number = cells.end - cells.begin;
  const int first = out.count;
  machine.fork("detect", [&](work::Core& core) {
    const auto [begin, end] = core.share(number);
    const int slice = first + begin * options.per_cell;
    I found = 0;
    for (int c : P::range(cells.begin + begin, cells.begin + end)) {
      const I row = I(c) / I(columns);
      const I column = I(c) - row * I(columns);
      const int place = slice + work::value(found);
      const int room = first + end * options.per_cell - place;
      BestOfCell<P> best(out.x.subspan(place, room), out.y.subspan(place, room), options.per_cell);
      detect_in_box<P>(image, box_of_cell<P>(image, options, column, row), tables, options, best);
      found += best.count();
    }
    kept[core.id] = found;
  });
  out.count += compact_slices<P>(number, options.per_cell, kept, [&](int to, int from) {
    out.x[first + to] = work::narrow<U16>(I(out.x[first + from]));
    out.y[first + to] = work::narrow<U16>(I(out.y[first + from]));
  });
}

constexpr host::DiscMask kWindowDisc = host::make_disc_mask(kSquaredDiscRadius);

/// Writes the descriptors of these features to `words`, the first of them to the first place: the
/// fork "describe", in slices of ceil(n / cores).
template <class P, class Kind>
void describe_all(work::Machine& machine, ConstImageView<P> blurred, work::Share features,
                  const FeatureList<P>& list, typename P::template Span<typename P::U32> words) {
  using I = typename P::I32;
  using U = typename P::U32;
  const typename P::template Span<const U> pattern(Kind::template pattern<P>().data(), kPairs);
  const int n = features.end - features.begin;
  const int rows_above = blurred.top * blurred.width;
  machine.fork("describe", [&](work::Core& core) {
    const int each = (n + core.cores - 1) / core.cores;
    for (int i : P::range(std::min(n, core.id * each), std::min(n, (core.id + 1) * each))) {
      const int feature = features.begin + i;
      const I at = I(list.y[feature]) * I(blurred.width) + I(list.x[feature]);
      // The windows around it are streams from a computed place.
      const int centre = work::value(at) - rows_above;
      const Moments<P> moments =
          moments_at<P>(kWindowDisc, blurred, centre, [&]() LEVIOSIM_HOST_INLINED {
            return levio::disc_moments<P>(blurred.pixels, blurred.width, centre);
          });
      describe<P, Kind>(blurred.pixels, blurred.width, centre, direction_of<P>(moments), pattern,
                        words.subspan(kDescriptorWords * i, kDescriptorWords));
    }
  });
}

/// The steps of the released program; its tables lie in local memory.
template <class P>
class Steps {
 public:
  using Words = typename P::template Span<typename P::U32>;

  Steps(work::Machine& machine, const ExtractorOptions& options, DescriptorKind kind, int width)
      : machine_(machine),
        options_(options),
        kind_(kind),
        kept_(machine.local().alloc<typename P::template Span<typename P::I32>>(
            "keypoints per core", machine.cores())),
        tables_(machine.local(), width) {}

  void detect(ConstImageView<P> image, work::Share cells, FeatureList<P>& out) const {
    detect_all<P>(machine_, image, tables_, kept_, options_, cells, out);
  }
  void blur(ConstImageView<P> image, ImageView<P> blurred, work::Share rows) const {
    machine_.fork("blur", [&](work::Core& core) {
      const auto [begin, end] = core.share(rows.end - rows.begin);
      levio::blur_rows<P>(image, blurred, rows.begin + begin, rows.begin + end);
    });
  }
  void describe(ConstImageView<P> blurred, work::Share features, const FeatureList<P>& list,
                Words words) const {
    if (kind_ == DescriptorKind::Released)
      describe_all<P, ReleasedDescriptor>(machine_, blurred, features, list, words);
    else
      describe_all<P, ExactDescriptor>(machine_, blurred, features, list, words);
  }

 private:
  work::Machine& machine_;
  const ExtractorOptions& options_;
  DescriptorKind kind_;
  typename P::template Span<typename P::I32> kept_;
  OffsetTables<P> tables_;
};

template <class P>
void check_arguments(const ImageView<P>& image, const ExtractorOptions& options,
                     const FeatureList<P>& out) {
  options.validate();
  check(out.capacity >= options.max_features(image.width, image.height),
        "the feature list has room for every feature of the image");
}

}  // namespace

template <class P>
void extract_features(work::Machine& machine, ImageView<P> image_in_l2,
                      const ExtractorOptions& options, DescriptorKind kind, FeatureList<P>& out) {
  using Bytes = typename P::template Span<typename P::Byte>;
  check_arguments<P>(image_in_l2, options, out);
  const int width = image_in_l2.width, height = image_in_l2.height;
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);
  const ImageView<P> image{memory.alloc<Bytes>("image", width * height), width, height};
  const ImageView<P> blurred{memory.alloc<Bytes>("blurred image", width * height), width, height};
  const Steps<P> steps(machine, options, kind, width);
  machine.copy_in(image.pixels, image_in_l2.pixels);
  out.count = 0;
  steps.detect(image, {0, options.cells_along(width) * options.cells_along(height)}, out);
  steps.blur(image, blurred, {0, height});
  steps.describe(blurred, {0, out.count}, out, out.descriptors);
  // Last, because descriptors are of whole pixels.
  if (options.subpixel_steps > 1) refine_keypoints<P>(machine, image, options, {0, out.count}, out);
}

template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                DescriptorKind kind, FeatureList<P>& out) {
  check_arguments<P>(image_in_l2, options, out);
  const work::Arena::Frame frame(machine.local());
  const Steps<P> steps(machine, options, kind, image_in_l2.width);
  run_strip_steps<P>(machine, image_in_l2, blurred_in_l2, options,
                     {[&](auto view, auto cells, auto& list) { steps.detect(view, cells, list); },
                      [&](auto view, auto blurred, auto rows) { steps.blur(view, blurred, rows); },
                      [&](auto view, auto features, auto& list, auto words) {
                        steps.describe(view, features, list, words);
                      }},
                     out);
}

template void extract_features_in_strips(work::Machine&, ImageView<work::Native>,
                                         ImageView<work::Native>, const ExtractorOptions&,
                                         DescriptorKind, FeatureList<work::Native>&);
template void extract_features_in_strips(work::Machine&, ImageView<work::Counting>,
                                         ImageView<work::Counting>, const ExtractorOptions&,
                                         DescriptorKind, FeatureList<work::Counting>&);
template void extract_features(work::Machine&, ImageView<work::Native>, const ExtractorOptions&,
                               DescriptorKind, FeatureList<work::Native>&);
template void extract_features(work::Machine&, ImageView<work::Counting>, const ExtractorOptions&,
                               DescriptorKind, FeatureList<work::Counting>&);

}  // namespace leviosim::vio::levio
