// Feature extraction with the released program's work (PARAMETERS.md#feature-extraction): the same
// three forks as workload/vision/extractor.h, and features at the same places. Their descriptors
// differ from those in the pattern of pairs (learned_pairs.h), and in what the disc and the
// rounding of the release change. Images that do not fit in local memory pass through it in strips,
// as those of the shared extraction do (workload/vision/strip_extractor.h).
#pragma once

#include "sim/work/machine.h"
#include "workload/vision/extractor.h"

namespace leviosim::vio::levio {

enum class DescriptorKind {
  Exact,    ///< pairs of points are turned exactly; their pattern follows ORB's rules
  Released  ///< they are turned with the release's slip; their pattern finds as few matches
};

/// Extracts the features of an 8-bit image that lies in L2 and fits in local memory into `out`,
/// whose capacity must be at least options.max_features(). The caller opens the stage.
template <class P>
void extract_features(work::Machine& machine, ImageView<P> image_in_l2,
                      const ExtractorOptions& options, DescriptorKind kind, FeatureList<P>& out);

/// The same features of an image that does not fit.
/// @param blurred_in_l2  room for its blurred copy, of the same size
/// @throws InputError if not even one row of cells fits in local memory
template <class P>
void extract_features_in_strips(work::Machine& machine, ImageView<P> image_in_l2,
                                ImageView<P> blurred_in_l2, const ExtractorOptions& options,
                                DescriptorKind kind, FeatureList<P>& out);

}  // namespace leviosim::vio::levio
