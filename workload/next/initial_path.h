// The frames since the camera first moved, each as the IMU's motion since the keyframe before, so
// that their poses can be corrected when the map is aligned. The poses of keyframes that have left
// the map, or were of a map that was given up, follow from the oldest keyframe of the map and the
// IMU backwards. In L2; the oldest frames are forgotten.
#pragma once

#include <optional>
#include <vector>

#include "workload/vio/front_end_state.h"
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
  /// @param frames           number of frames remembered; 0: nothing is, and no memory is taken
  InitialPath(const FrontEndState<P>& state, const InertialPart<P>& inertial, work::Arena& arena,
              int frames);

  /// Takes the motion since the last keyframe, before the present frame becomes one.
  /// @param dt  since the frame before [s]
  void take_motion(float dt);
  /// The present frame, after it has become a keyframe or not.
  void remember();
  bool empty() const { return count_ == 0; }
  void clear() { count_ = 0; }
  /// Where the frames were, as far as their poses wait still. Call it with the frame after the last
  /// one that was remembered, before take_motion(). @param dt  since that one [s]
  std::vector<EarlierPose> poses(float dt) const;

 private:
  static constexpr int kFloats = Preintegration<P>::kMotionFloats;
  using L2Ids = typename P::template L2Span<I32>;

  I32 newest_keyframe() const;
  std::optional<KeyframeState<P>> keyframe(I32 id) const;

  const FrontEndState<P>& state_;
  const InertialPart<P>& inertial_;
  int frames_;
  int count_ = 0;  ///< frames remembered since they were cleared, forgotten ones included
  float now_s_ = 0;
  std::vector<float> taken_s_;  ///< when the frames were
  Floats motions_;
  L2Ids since_;   ///< serial numbers of the keyframes before, -1 for the first frame of all
  L2Ids became_;  ///< of the frame as a keyframe, or that of the keyframe before
};

}  // namespace leviosim::vio
