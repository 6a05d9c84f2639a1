// The front end of `next`: guided matching around the IMU's prediction, detection of rest, and
// rejection of implausible poses and maps.
#pragma once

#include <optional>

#include "workload/levio/geometry/sampling.h"
#include "workload/next/fixed_in_view.h"
#include "workload/next/initial_path.h"
#include "workload/next/loop/loop_part.h"
#include "workload/next/motion_record.h"
#include "workload/next/own_motion.h"
#include "workload/next/prediction.h"
#include "workload/vio/front_end.h"
#include "workload/vio/front_end_state.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

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

  /// Evidence of rest in the images while the IMU shows rest.
  struct ImageRest {
    Vec3<P> motion{0.0f, 0.0f, 0.0f};  ///< translation in the last second, as a share of depth
    float time = 0;                    ///< time observed [s]
    bool was_seen = false;             ///< the images have shown no motion for long enough
  };

  bool repeats_last(const Frame<P>& frame);
  bool starts_at_rest() const;
  void look_for_motion(TrackedFrame<P>& frame);
  bool began_in_motion() const;
  bool has_one_keyframe() const;
  void match_last_keyframe(TrackedFrame<P>& frame);
  void come_to_rest(TrackedFrame<P>& frame, FrameReport& report, const Stillness<P>& rest);
  void start_at_rest(TrackedFrame<P>& frame, const Stillness<P>& rest,
                     const std::optional<Vec3<P>>& held);
  bool images_rest() const;
  void start_anew(TrackedFrame<P>& frame);
  bool initialises() const;
  void correct_path(float dt, FrameReport& report);
  float any_depth() const;
  std::optional<Vec3<P>> held_position() const;
  void follow(TrackedFrame<P>& frame, FrameReport& report);
  void locate(TrackedFrame<P>& frame, FrameReport& report);
  std::optional<Pose<P>> pose_by_prediction(const TrackedFrame<P>& frame, FrameReport& report);
  std::optional<Pose<P>> still_pose(const Frame<P>& frame);
  bool within_noise(const Pose<P>& now, const Pose<P>& last) const;
  Pose<P> held_at_rest(const Pose<P>& T_world_camera);
  bool is_keyframe(const Frame<P>& frame, const FrameReport& report);

  FrontEndState<P> state_;
  MapStatus& map_;
  InertialPart<P> inertial_;
  Prediction<P> prediction_;
  levio::ShiftRegister<P> random_;   ///< of both estimators
  std::optional<LoopPart<P>> loop_;  ///< if loops are closed
  FixedInView<P> fixed_;
  OwnMotion<P> own_motion_;
  InitialPath<P> path_;  ///< frames before the end of the alignment
  float settling_ = 0;   ///< time since its alignment, s
  bool waited_ = false;  ///< the map was not aligned at the frame before
  typename P::U32 sum_;  ///< over the features of the frame before
  bool still_ = false;   ///< the images say that the camera has not moved since the keyframe
  bool rests_ = false;   ///< … and has not turned either
  bool rested_ = false;  ///< the frame before began a map, or rested where it began
  ImageRest rest_;
};

}  // namespace leviosim::vio
