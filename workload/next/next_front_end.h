// The front end of `next`: it looks for landmarks where the IMU predicts them, knows when the
// vehicle stands still, and does not believe what cannot be true.
#pragma once

#include <optional>
#include <vector>

#include "workload/levio/geometry/sampling.h"
#include "workload/next/loop/loop_part.h"
#include "workload/next/motion_record.h"
#include "workload/next/prediction.h"
#include "workload/vio/front_end_state.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

// The frames since images were first seen in motion, each as what the IMU measured since the
// keyframe before, so that their poses can be corrected when the map is aligned. Of keyframes that
// have left the map, or were of a map that was given up, the IMU tells where they were: it is
// followed back from the oldest that is there. In L2; the oldest frames are forgotten.

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

  /// What images show while the IMU sees rest.
  struct ImageRest {
    Vec3<P> motion{0.0f, 0.0f, 0.0f};  ///< of the last second, over the distance of what is seen
    float time = 0;                    ///< looked at, s
    bool was_seen = false;             ///< for a while nothing moved
  };

  bool repeats_last(const Frame<P>& frame);
  bool starts_at_rest() const;
  void look_for_motion(TrackedFrame<P>& frame);
  bool began_in_motion() const;
  bool has_one_keyframe() const;
  void match_last_keyframe(TrackedFrame<P>& frame);
  void start_at_rest(TrackedFrame<P>& frame, const Stillness<P>& rest);
  bool images_rest() const;
  void start_anew(TrackedFrame<P>& frame);
  bool initialises() const;
  void correct_path(float dt, FrameReport& report);
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
  InitialPath<P> path_;              ///< until the map has settled
  float settling_ = 0;               ///< time since its alignment, s
  typename P::U32 sum_;              ///< over the features of the frame before
  bool still_ = false;  ///< the images say that the camera has not moved since the keyframe
  bool rests_ = false;  ///< nor turned
  ImageRest rest_;
};

}  // namespace leviosim::vio
