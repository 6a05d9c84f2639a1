#include "workload/vision/extractor.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "workload/vision/extraction_steps.h"

namespace leviosim::vio {

int ExtractorOptions::cells_along(int side) const {
  return std::max(0, side - 2 * border + cell - 1) / cell;
}

int ExtractorOptions::max_features(int width, int height) const {
  return cells_along(width) * cells_along(height) * per_cell;
}

Bytes ExtractorOptions::memory_of_whole_image(int width, int height, int cores) const {
  const int words =
      ExtractionTables<work::Native>::kIntegers + cores + (pattern_in_local_memory ? kPairs : 0);
  return Bytes(2LL * width * height + 4LL * words);
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
  using Bytes = typename P::template Span<typename P::Byte>;

  Workspace(work::Arena& arena, int width, int height, int cores)
      : image{arena.alloc<Bytes>("image", width * height), width, height},
        blurred{arena.alloc<Bytes>("blurred image", width * height), width, height},
        tables(arena, cores) {}

  ImageView<P> image, blurred;
  ExtractionTables<P> tables;
};

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
  machine.copy_in(work.image.pixels, image_in_l2.pixels);
  load_tables<P>(machine, image_in_l2.width, work.tables);

  out.count = 0;
  const int cells = options.cells_along(work.image.width) * options.cells_along(work.image.height);
  detect_all<P>(machine, work.image, work.tables, options, {0, cells}, out);

  machine.fork("blur", [&](work::Core& core) {
    const auto [begin, end] = core.share(work.image.height);
    blur_rows<P>(work.image, work.blurred, begin, end, work.tables.blur_kernel);
  });

  with_pattern<P>(machine, options, [&](auto pattern) {
    describe_all<P>(machine, work.blurred, work.tables, pattern, {0, out.count}, out,
                    out.descriptors);
  });
  // Last, because descriptors are of whole pixels.
  if (options.subpixel_steps > 1)
    refine_keypoints<P>(machine, work.image, options, {0, out.count}, out);
}

template void extract_features<work::Native>(work::Machine&, ImageView<work::Native>,
                                             const ExtractorOptions&, FeatureList<work::Native>&);
template void extract_features<work::Counting>(work::Machine&, ImageView<work::Counting>,
                                               const ExtractorOptions&,
                                               FeatureList<work::Counting>&);

}  // namespace leviosim::vio
