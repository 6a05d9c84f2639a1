// The front end of `next`: it looks for landmarks where the IMU predicts them, knows when the
// vehicle stands still, and does not believe what cannot be true.
#pragma once

#include <optional>

#include "workload/vio/front_end.h"
#include "workload/vio/loop/loop_part.h"
#include "workload/vio/next/prediction.h"

namespace leviosim::vio {

template <class P>
class NextFrontEnd : public FrontEnd<P> {
 public:
  /// @param profile  outlives this
  /// @param graph    in L2; shared with the back end
  NextFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
               work::Arena& keyframe_memory, work::Arena& loop_memory, const PoseGraph<P>& graph);

  FrameReport process(const FrameInput& input) override;

 private:
  using Floats = typename P::template Span<typename P::F32>;

  void start_at_rest(TrackedFrame<P>& frame);
  void start_anew(TrackedFrame<P>& frame);
  void locate(TrackedFrame<P>& frame, FrameReport& report);
  std::optional<Pose<P>> pose_by_prediction(const TrackedFrame<P>& frame, FrameReport& report);
  Pose<P> settled(const Pose<P>& T_world_camera);
  bool is_keyframe(const Frame<P>& frame, const FrameReport& report);

  FrontEndState<P> state_;
  InertialPart<P> inertial_;
  Prediction<P> prediction_;
  std::optional<LoopPart<P>> loop_;  ///< if loops are closed
  bool may_rest_ = true;  ///< the images have not contradicted that the vehicle stands still
};

}  // namespace leviosim::vio
