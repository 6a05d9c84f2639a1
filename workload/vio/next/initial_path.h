// The frames since a map began in motion, each as what the IMU measured since its keyframe, so that
// their poses can be corrected when the map is aligned. In L2; the oldest frames are forgotten.
#pragma once

#include <vector>

#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

template <class P>
class InitialPath {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Floats = typename P::template Span<F>;
  using Ids = typename P::template Span<I32>;

  /// @param state, inertial  outlive this
  /// @param frames           that are remembered; with 0 nothing is, and no memory taken
  InitialPath(const FrontEndState<P>& state, const InertialPart<P>& inertial, work::Arena& arena,
              int frames);

  void clear() { count_ = 0; }
  /// The present frame, after it has become a keyframe or not.
  void remember();
  /// Where the frames were, of those whose keyframes are still there. Clears the path. Call it with
  /// the frame after the last one that was remembered.
  std::vector<EarlierPose> poses();

 private:
  static constexpr int kFloats = Preintegration<P>::kMotionFloats;

  const FrontEndState<P>& state_;
  const InertialPart<P>& inertial_;
  int frames_;
  int count_ = 0;  ///< frames remembered since clear(), forgotten ones included
  Floats intervals_;
  typename P::template L2Span<I32> keyframe_ids_;
};

}  // namespace leviosim::vio
