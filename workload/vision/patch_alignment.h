// Where a feature of one image lies in another, to a fraction of a pixel: the patch around it is
// moved over the other image until the grey levels agree best (Lucas and Kanade 1981), by steps
// whose derivatives are those of the patch (inverse compositional: Baker and Matthews 2004).
//
// A detector finds a corner again within a pixel; patches agree within a tenth of one. Unknown are
// the two coordinates and the difference of brightness; the patch is not turned or scaled, so the
// images must be near each other.
#pragma once

#include "sim/work/machine.h"
#include "workload/math/vec.h"
#include "workload/vision/features.h"
#include "workload/vision/matcher.h"

namespace leviosim::vio {

struct PatchAlignmentOptions {
  static constexpr int kMostRadius = 8;

  bool enabled = false;
  int radius = 3;           ///< the patch has 2·radius + 1 pixels a side, at most kMostRadius
  int iterations = 6;       ///< most iterations of a patch
  float last_step = 0.03f;  ///< step below which the iteration ends [px]
  float max_shift = 1.5f;   ///< largest shift from the detected corner, in each direction [px]
  /// Largest sum of squared differences of two patches that agree, without their means, as a share
  /// of the sum of squares of the patch.
  float max_difference = 0.3f;
  bool required = true;  ///< a match whose patches do not agree is rejected
  float reach = 3.0f;    ///< largest shift from a landmark's predicted pixel, likewise [px]
};

/// The result of a match's alignment.
enum class PatchVerdict : std::int8_t {
  Unknown,   ///< the patch lies partly outside of the image, or has too little texture
  Agrees,    ///< the feature was moved to where the patches agree
  Disagrees  ///< the patches agree nowhere near the feature
};

/// An image and the features in it that are matched. Coordinates are in units of 1/steps px. An
/// image may lie in L2: then a core copies the window around each feature.
template <class P>
struct PatchView {
  ConstImageView<P> image;
  typename P::template EitherSpan<typename P::U16> x, y;
  bool in_l2 = false;  ///< the image
};

/// Local memory that each core takes: 12 bytes per pixel of a patch, and the windows of images that
/// lie in L2.
Bytes patch_scratch(const PatchAlignmentOptions& options, float max_shift, bool before_in_l2,
                    bool now_in_l2);

/// Moves the features of `now` that `matches` (query) pairs with features of `before` (reference)
/// to where their patches agree. Features that do not agree within max_shift (px) stay.
/// One team fork, "align". The caller opens the stage.
/// Local memory while it runs: patch_scratch() of each core.
/// @param aligned  what became of each match, a PatchVerdict
template <class P>
void align_patches(work::Machine& machine, const PatchView<P>& before, const PatchView<P>& now,
                   int steps, float max_shift, const PatchAlignmentOptions& options,
                   const MatchList<P>& matches,
                   typename P::template Span<typename P::Byte> aligned);

}  // namespace leviosim::vio
