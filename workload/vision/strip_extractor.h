// Feature extraction from images that do not fit in local memory: the same features, bit by bit, as
// extract_features() finds, from strips of rows that pass through two buffers.
//
// Four passes over strips of whole rows of cells, each with the forks of the whole image: "detect",
// "blur" (whose result goes back to L2), "describe", and "refine" if there are corners between
// pixels. What the strips share with their neighbours is read again by the DMA rather than kept.
#pragma once

#include "workload/vision/extractor.h"

namespace leviosim::vio {

/// @param image_in_l2    8-bit image
/// @param blurred_in_l2  room for its blurred copy, of the same size
/// @param out            as for extract_features()
/// @throws InputError if not even one row of cells fits in local memory
template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                FeatureList<P>& out);

}  // namespace leviosim::vio
