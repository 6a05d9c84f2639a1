// Corners between pixels: the point to which the gradients around a keypoint belong best (Förstner
// and Gülch 1987): every gradient g at p says that the corner c lies on the edge through p, so
// gᵀ (c − p) = 0, and c solves Σ g gᵀ c = Σ g gᵀ p. One step from the pixel that the detector
// found, over a 7×7 window of 3×3 Sobel gradients, as the corner score sees it.
//
// A corner that would lie farther away than the caller allows belongs to something else; the
// keypoint then stays in the middle of its pixel.
#pragma once

#include "sim/work/machine.h"
#include "workload/math/vec.h"
#include "workload/vision/extractor.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// Offset of the corner from the pixel (x, y), in px. The 9×9 pixels around it lie in the image.
/// @param max_shift  in each direction, px; beyond it the offset is zero
template <class P>
Vec2<P> corner_offset(typename P::template Span<const typename P::Byte> image, int width, int x,
                      int y, float max_shift);

/// Replaces the coordinates of the keypoints [which.begin, which.end) by those of their corners in
/// units of 1/options.subpixel_steps px. One team fork, "refine".
template <class P>
void refine_keypoints(work::Machine& machine, ConstImageView<P> image,
                      const ExtractorOptions& options, work::Share which,
                      const FeatureList<P>& features);

}  // namespace leviosim::vio
