// Feature extraction from images that do not fit in local memory: the same features, bit by bit, as
// from whole images, from strips of rows that pass through two buffers (sim/work/tiles.h).
//
// Four passes over strips of whole rows of cells, each with the forks of the whole image: "detect",
// "blur" (whose result goes back to L2), "describe", and "refine" if there are corners between
// pixels. What the strips share with their neighbours is read again by the DMA rather than kept.
// How the steps compute is theirs: those of extract_features(), or the released program's.
#pragma once

#include <algorithm>
#include <functional>

#include "sim/work/tiles.h"
#include "workload/vision/extractor.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// @param image_in_l2    8-bit image
/// @param blurred_in_l2  room for its blurred copy, of the same size
/// @param out            as for extract_features(); its descriptors may lie in L2
/// @throws InputError if not even one row of cells fits in local memory
template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                FeatureList<P>& out);

/// What is done with the rows that are there; each is a fork.
template <class P>
struct StripSteps {
  /// Appends the keypoints of these cells to the list.
  std::function<void(ConstImageView<P>, work::Share cells, FeatureList<P>&)> detect;
  std::function<void(ConstImageView<P>, ImageView<P> blurred, work::Share rows)> blur;
  /// Writes the descriptors of these features, the first of them to the first place.
  std::function<void(ConstImageView<P> blurred, work::Share features, const FeatureList<P>&,
                     typename P::template Span<typename P::U32> descriptors)>
      describe;
};

/// The passes over strips, after the tables of the steps have been allocated.
template <class P>
void run_strip_steps(work::Machine& machine, ImageView<P> image_in_l2, ImageView<P> blurred_in_l2,
                     const ExtractorOptions& options, const StripSteps<P>& steps,
                     FeatureList<P>& out);

}  // namespace leviosim::vio
