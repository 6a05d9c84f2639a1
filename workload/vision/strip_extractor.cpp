#include "workload/vision/strip_extractor.h"

#include <fmt/format.h>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "workload/vision/extraction_steps.h"

namespace leviosim::vio {
namespace {

/// Rows of pixels that the buffers of a pass over `rows` rows take.
int rows_of_buffers(int rows, int reach, int buffers) { return buffers * (rows + 2 * reach); }

/// Bytes of a buffer for the descriptors of all features that rows of cells can have.
Bytes descriptors_of(const ExtractorOptions& options, int width, int cell_rows) {
  const int features = cell_rows * options.cells_along(width) * options.per_cell;
  return Bytes(4LL * features * kDescriptorWords);
}

struct StripSize {
  int cell_rows;
  int buffers;
};

/// The most rows of cells whose strips fit in `memory` in every pass, twice, so that one is fetched
/// while the other is worked on; one row at a time where not even one fits twice.
/// @param descriptors  whether descriptors pass, too
StripSize size_of_strips(const ExtractorOptions& options, int width, int height, bool descriptors,
                         const work::Arena& memory) {
  const auto missing = [&](int cell_rows, int buffers) {
    const int rows = cell_rows * options.cell;
    const auto bytes = [&](int n) { return Bytes(static_cast<std::int64_t>(n) * width); };
    const Bytes described =
        descriptors ? descriptors_of(options, width, cell_rows) * buffers : Bytes(0);
    return std::max({bytes(rows_of_buffers(rows, kHarrisReach, buffers)),
                     bytes(rows_of_buffers(rows, kBlurRadius, buffers) +
                           rows_of_buffers(rows, 0, buffers)),
                     bytes(rows_of_buffers(rows, kDescriptorReach, buffers)) + described}) -
           memory.free();
  };
  if (missing(1, 1) > Bytes(0))
    throw work::MemoryOverflow(
        fmt::format("feature extraction: strips of one row of cells of {} px, from an image of "
                    "{}x{} px, do not fit in {}: {} of {} bytes are in use, {} bytes are missing",
                    options.cell, width, height, memory.name(), memory.used().count(),
                    memory.capacity().count(), missing(1, 1).count()),
        std::string(memory.name()), missing(1, 1));
  if (missing(1, 2) > Bytes(0)) return {1, 1};
  int cell_rows = 1;
  while (cell_rows < options.cells_along(height) && missing(cell_rows + 1, 2) <= Bytes(0))
    ++cell_rows;
  return {cell_rows, 2};
}

/// Calls work(i, strip, rows) for every strip of `image_in_l2`, where `rows` is a view of the rows
/// that were read.
/// @param again  an image in local memory would not be read
template <class P, class Work>
void for_each_strip(work::Machine& machine, ConstImageView<P> image_in_l2,
                    const work::TilePlan& plan, bool again, Work&& work) {
  const int width = image_in_l2.width;
  work::for_each_tile<P>(
      machine, plan,
      [&](int i, const work::Tile& strip, typename P::template Span<typename P::Byte> rows) {
        work(i, strip, ConstImageView<P>{rows, width, image_in_l2.height, strip.first});
      },
      work::PassingBlock<P, typename P::Byte>{"image strip", image_in_l2.pixels, width, again});
}

/// Blurs all rows; strips of the result go back to L2 while the next ones are computed.
template <class P>
void blur_in_strips(work::Machine& machine, ConstImageView<P> image_in_l2,
                    ImageView<P> blurred_in_l2, const StripSteps<P>& steps, int rows, int buffers) {
  const work::Arena::Frame memory(machine.local());
  const int width = image_in_l2.width, height = image_in_l2.height;
  work::TilesOut<P, typename P::Byte> results(machine, "blurred strip", rows * width, true,
                                              buffers);
  for_each_strip<P>(
      machine, image_in_l2, work::TilePlan(0, height, rows, kBlurRadius, height, buffers), true,
      [&](int, const work::Tile& strip, ConstImageView<P> view) {
        steps.blur(view, {results.next(machine), width, height, strip.begin},
                   {strip.begin, strip.end});
        results.send(machine,
                     blurred_in_l2.pixels.subspan(strip.begin * width, strip.size() * width));
      });
  results.finish(machine);
}

/// Describes the features of every strip. Descriptors whose place is in L2 pass through tiles.
template <class P, class FeaturesOf>
void describe_in_strips(work::Machine& machine, ConstImageView<P> blurred_in_l2,
                        const StripSteps<P>& steps, const work::TilePlan& plan, int most_features,
                        const FeaturesOf& features_of, FeatureList<P>& out) {
  const work::Arena::Frame memory(machine.local());
  const auto words_of = [&](work::Share features) {
    return out.descriptors.subspan(kDescriptorWords * features.begin,
                                   kDescriptorWords * (features.end - features.begin));
  };
  if (!out.descriptors_in_l2)
    return for_each_strip<P>(machine, blurred_in_l2, plan, true,
                             [&](int i, const work::Tile&, ConstImageView<P> view) {
                               const work::Share features = features_of(i);
                               steps.describe(view, features, out, words_of(features));
                             });
  work::TilesOut<P, typename P::U32> results(
      machine, "descriptors of a strip", kDescriptorWords * most_features, true, plan.buffers());
  for_each_strip<P>(machine, blurred_in_l2, plan, true,
                    [&](int i, const work::Tile&, ConstImageView<P> view) {
                      const work::Share features = features_of(i);
                      if (features.begin == features.end) return;
                      steps.describe(view, features, out, results.next(machine));
                      results.send(machine, words_of(features));
                    });
  results.finish(machine);
}

}  // namespace

template <class P>
void run_strip_steps(work::Machine& machine, ImageView<P> image_in_l2, ImageView<P> blurred_in_l2,
                     const ExtractorOptions& options, const StripSteps<P>& steps,
                     FeatureList<P>& out) {
  using I = typename P::I32;
  const int width = image_in_l2.width, height = image_in_l2.height;
  const int rows_of_cells = options.cells_along(height);
  const int columns = options.cells_along(width);
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);
  // Element s: the number of features in the strips before s.
  const auto until =
      memory.alloc<typename P::template Span<I>>("features until strip", rows_of_cells + 1);
  const StripSize size = size_of_strips(options, width, height, out.descriptors_in_l2, memory);
  const int cell_rows = size.cell_rows;
  const auto strips = [&](int reach) {
    return work::TilePlan(options.border, height - options.border, cell_rows * options.cell, reach,
                          height, size.buffers);
  };
  const auto features_of = [&](int strip) {
    return work::Share{work::value(I(until[strip])), work::value(I(until[strip + 1]))};
  };
  out.count = 0;
  until[0] = I(0);
  for_each_strip<P>(machine, image_in_l2, strips(kHarrisReach), false,
                    [&](int i, const work::Tile&, ConstImageView<P> view) {
                      const int begin = i * cell_rows;
                      const int end = std::min(begin + cell_rows, rows_of_cells);
                      steps.detect(view, {begin * columns, end * columns}, out);
                      until[i + 1] = I(out.count);
                    });
  blur_in_strips<P>(machine, image_in_l2, blurred_in_l2, steps, cell_rows * options.cell,
                    size.buffers);
  describe_in_strips<P>(machine, blurred_in_l2, steps, strips(kDescriptorReach),
                        cell_rows * columns * options.per_cell, features_of, out);
  // Last, because descriptors are of whole pixels.
  if (options.subpixel_steps > 1)
    for_each_strip<P>(machine, image_in_l2, strips(kHarrisReach), true,
                      [&](int i, const work::Tile&, ConstImageView<P> view) {
                        refine_keypoints<P>(machine, view, options, features_of(i), out);
                      });
}

template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                FeatureList<P>& out) {
  options.validate();
  check(out.capacity >= options.max_features(image_in_l2.width, image_in_l2.height),
        "the feature list has room for every feature of the image");
  check_equal(blurred_in_l2.pixels.size(), image_in_l2.pixels.size(), "pixels of the blurred copy");
  const work::Arena::Frame frame(machine.local());
  ExtractionTables<P> tables(machine.local(), machine.cores());
  load_tables<P>(machine, image_in_l2.width, tables);
  with_pattern<P>(machine, options, [&](auto pattern) {
    const StripSteps<P> steps{
        [&](ConstImageView<P> view, work::Share cells, FeatureList<P>& to) {
          detect_all<P>(machine, view, tables, options, cells, to);
        },
        [&](ConstImageView<P> view, ImageView<P> result, work::Share rows) {
          machine.fork("blur", [&](work::Core& core) {
            const auto [begin, end] = core.share(rows.end - rows.begin);
            blur_rows<P>(view, result, rows.begin + begin, rows.begin + end, tables.blur_kernel);
          });
        },
        [&](ConstImageView<P> view, work::Share features, const FeatureList<P>& list,
            typename P::template Span<typename P::U32> words) {
          describe_all<P>(machine, view, tables, pattern, features, list, words);
        }};
    run_strip_steps<P>(machine, image_in_l2, blurred_in_l2, options, steps, out);
  });
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template void run_strip_steps(work::Machine&, ImageView<P>, ImageView<P>,                      \
                                const ExtractorOptions&, const StripSteps<P>&, FeatureList<P>&); \
  template void extract_features_in_strips(work::Machine&, ImageView<P>, ImageView<P>,           \
                                           const ExtractorOptions&, FeatureList<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
