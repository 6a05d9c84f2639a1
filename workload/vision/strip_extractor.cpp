#include "workload/vision/strip_extractor.h"

#include <fmt/format.h>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "workload/vision/extraction_steps.h"

namespace leviosim::vio {
namespace {

/// Rows of pixels that two buffers of a pass over `rows` rows take.
int rows_of_buffers(int rows, int reach) { return 2 * (rows + 2 * reach); }

/// The most rows of cells whose strips fit in `memory` in every pass.
int cell_rows_per_strip(const ExtractorOptions& options, int width, int height,
                        const work::Arena& memory) {
  const auto missing = [&](int cell_rows) {
    const int rows = cell_rows * options.cell;
    const int most = std::max({rows_of_buffers(rows, kHarrisReach),
                               rows_of_buffers(rows, kBlurRadius) + rows_of_buffers(rows, 0),
                               rows_of_buffers(rows, kDescriptorReach)});
    return Bytes(static_cast<std::int64_t>(most) * width) - memory.free();
  };
  if (missing(1) > Bytes(0))
    throw InputError(fmt::format(
        "feature extraction: strips of one row of cells of {} px, from an image of {}x{} px, do "
        "not "
        "fit in {}: {} of {} bytes are in use, {} bytes are missing; expected smaller cells "
        "(workload.cell), fewer features (workload.features_per_cell), or a smaller image",
        options.cell, width, height, memory.name(), memory.used().count(),
        memory.capacity().count(), missing(1).count()));
  int cell_rows = 1;
  while (cell_rows < options.cells_along(height) && missing(cell_rows + 1) <= Bytes(0)) ++cell_rows;
  return cell_rows;
}

/// Blurs all rows; strips of the result go back to L2 while the next ones are computed.
template <class P>
void blur_in_strips(work::Machine& machine, ConstImageView<P> image_in_l2,
                    ImageView<P> blurred_in_l2, const ExtractionTables<P>& tables, int rows) {
  using Pixels = typename P::template Span<typename P::Byte>;
  const work::Arena::Frame memory(machine.local());
  const int width = image_in_l2.width;
  const StripPlan plan(0, image_in_l2.height, rows, kBlurRadius, image_in_l2.height);
  std::array<Pixels, 2> results;
  for (Pixels& result : results)
    result = machine.local().template alloc<Pixels>("blurred strip", rows * width);
  std::array<work::Machine::Ticket, 2> under_way;
  for_each_strip<P>(
      machine, image_in_l2, plan, [&](int i, const Strip& strip, ConstImageView<P> view) {
        const auto k = static_cast<std::size_t>(i % 2);
        if (i >= 2) machine.wait(under_way[k]);
        const ImageView<P> result{results[k], width, image_in_l2.height, strip.begin};
        machine.fork("blur", [&](work::Core& core) {
          const auto [begin, end] = core.share(strip.end - strip.begin);
          blur_rows<P>(view, result, strip.begin + begin, strip.begin + end, tables.blur_kernel);
        });
        const int pixels = (strip.end - strip.begin) * width;
        under_way[k] = machine.start_copy_out(
            blurred_in_l2.pixels.subspan(strip.begin * width, pixels), result.pixels);
      });
  const int last = plan.count() - 1;
  if (last >= 1) machine.wait(under_way[static_cast<std::size_t>((last - 1) % 2)]);
  machine.wait(under_way[static_cast<std::size_t>(last % 2)]);
}

}  // namespace

template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                FeatureList<P>& out) {
  using I = typename P::I32;
  using Table = typename P::template Span<I>;
  options.validate();
  const int width = image_in_l2.width, height = image_in_l2.height;
  check(out.capacity >= options.max_features(width, height),
        "the feature list has room for every feature of the image");
  check_equal(blurred_in_l2.pixels.size(), image_in_l2.pixels.size(), "pixels of the blurred copy");
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);
  const int rows_of_cells = options.cells_along(height);
  const int columns = options.cells_along(width);
  ExtractionTables<P> tables(memory, machine.cores());
  // Element s: the number of features in the strips before s.
  const Table until = memory.alloc<Table>("features until strip", rows_of_cells + 1);
  load_tables<P>(machine, width, tables);
  out.count = 0;

  with_pattern<P>(machine, options, [&](auto pattern) {
    const int cell_rows = cell_rows_per_strip(options, width, height, memory);
    const int rows = cell_rows * options.cell;
    const auto strips = [&](int reach) {
      return StripPlan(options.border, height - options.border, rows, reach, height);
    };
    const auto features_of = [&](int strip) {
      return work::Share{work::value(I(until[strip])), work::value(I(until[strip + 1]))};
    };
    until[0] = I(0);
    for_each_strip<P>(
        machine, image_in_l2, strips(kHarrisReach),
        [&](int i, const Strip&, ConstImageView<P> view) {
          const int begin = i * cell_rows;
          const int end = std::min(begin + cell_rows, rows_of_cells);
          detect_all<P>(machine, view, tables, options, {begin * columns, end * columns}, out);
          until[i + 1] = I(out.count);
        });
    blur_in_strips<P>(machine, image_in_l2, blurred_in_l2, tables, rows);
    for_each_strip<P>(machine, blurred_in_l2, strips(kDescriptorReach),
                      [&](int i, const Strip&, ConstImageView<P> view) {
                        describe_all<P>(machine, view, tables, pattern, features_of(i), out);
                      });
    // Last, because descriptors are of whole pixels.
    if (options.subpixel_steps > 1)
      for_each_strip<P>(machine, image_in_l2, strips(kHarrisReach),
                        [&](int i, const Strip&, ConstImageView<P> view) {
                          refine_keypoints<P>(machine, view, options, features_of(i), out);
                        });
  });
}

template void extract_features_in_strips<work::Native>(work::Machine&, ImageView<work::Native>,
                                                       ImageView<work::Native>,
                                                       const ExtractorOptions&,
                                                       FeatureList<work::Native>&);
template void extract_features_in_strips<work::Counting>(work::Machine&, ImageView<work::Counting>,
                                                         ImageView<work::Counting>,
                                                         const ExtractorOptions&,
                                                         FeatureList<work::Counting>&);

}  // namespace leviosim::vio
