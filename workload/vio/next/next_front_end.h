// The front end of `next`: it looks for landmarks where the IMU predicts them, knows when the
// vehicle stands still, and does not believe what cannot be true.
#pragma once

#include <optional>
#include <vector>

#include "workload/geometry/sampling.h"
#include "workload/vio/front_end_state.h"
#include "workload/vio/inertial_part.h"
#include "workload/vio/loop/loop_part.h"
#include "workload/vio/next/prediction.h"

namespace leviosim::vio {

// The frames since a map began in motion, each as what the IMU measured since its keyframe, so that
// their poses can be corrected when the map is aligned. In L2; the oldest frames are forgotten.

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

template <class P>
class NextFrontEnd : public FrontEnd<P> {
 public:
  /// @param profile, map  outlive this
  /// @param graph    in L2; shared with the back end
  NextFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
               work::Arena& keyframe_memory, work::Arena& loop_memory, const PoseGraph<P>& graph,
               MapStatus& map);

  FrameReport process(const FrameInput& input) override;

 private:
  using Floats = typename P::template Span<typename P::F32>;

  bool repeats_last(const Frame<P>& frame);
  void start_at_rest(TrackedFrame<P>& frame, const Stillness<P>& rest);
  bool images_rest() const;
  void start_anew(TrackedFrame<P>& frame);
  bool initialises() const;
  float any_depth() const;
  void hold_position(TrackedFrame<P>& frame) const;
  void follow(TrackedFrame<P>& frame, FrameReport& report);
  void locate(TrackedFrame<P>& frame, FrameReport& report);
  std::optional<Pose<P>> pose_by_prediction(const TrackedFrame<P>& frame, FrameReport& report);
  std::optional<Pose<P>> still_pose(const Frame<P>& frame);
  Pose<P> settled(const Pose<P>& T_world_camera);
  bool is_keyframe(const Frame<P>& frame, const FrameReport& report);

  FrontEndState<P> state_;
  MapStatus& map_;
  InertialPart<P> inertial_;
  Prediction<P> prediction_;
  levio::ShiftRegister<P> random_;   ///< of both estimators
  std::optional<LoopPart<P>> loop_;  ///< if loops are closed
  InitialPath<P> path_;              ///< while the map waits for its alignment
  typename P::U32 sum_;              ///< over the features of the frame before
  bool still_ = false;    ///< the images say that the camera has not moved since the keyframe
  bool rests_ = false;    ///< nor turned
  bool may_rest_ = true;  ///< the images have not contradicted that the vehicle stands still
};

}  // namespace leviosim::vio
