// What finds matches that are not of the world has in common: cells of the picture, in which
// evidence is counted, and taking such matches off the list.
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Square cells of the picture; those at the right and the lower edge may be cut.
template <class P>
class PictureCells {
 public:
  using I32 = typename P::I32;

  /// @param side  of a cell [px]
  PictureCells(const FrontEndState<P>& state, int side)
      : units_(side * state.profile.extractor.subpixel_steps),
        columns_((state.rig.width + side - 1) / side),
        count_(columns_ * ((state.rig.height + side - 1) / side)) {}

  int count() const { return count_; }
  /// Where a feature lies.
  I32 of(const FeatureList<P>& features, I32 feature) const {
    const I32 x = features.x[feature], y = features.y[feature];
    return y / I32(units_) * I32(columns_) + x / I32(units_);
  }

 private:
  int units_;  ///< side, in units of the features' coordinates
  int columns_, count_;
};

/// Takes the matches with the last keyframe off the list for which is_foreign(i) holds, and gives
/// up the landmarks that they show. What is left keeps its order. Works inside a stage.
template <class P, class IsForeign>
void drop_foreign(const FrontEndState<P>& state, Frame<P>& frame, const IsForeign& is_foreign) {
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  keep_matches(frame.matches.list, [&](int i) {
    if (!is_foreign(i)) return true;
    const I32 landmark = matches.landmarks[I32(matches.list.reference[i])];
    if (landmark != I32(kNoLandmark)) state.graph_in_l2.retire_landmark(landmark);
    return false;
  });
}

}  // namespace leviosim::vio
