// The front end as the paper has it (Fig. 1, right side; III.B): the pose of a frame from matches
// with the landmarks, or else from those with the last keyframe.
#pragma once

#include "workload/levio/geometry/sampling.h"
#include "workload/vio/frame.h"
#include "workload/vio/front_end.h"
#include "workload/vio/front_end_state.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

template <class P>
class LevioFrontEnd : public FrontEnd<P> {
 public:
  /// @param profile  outlives this
  /// @param graph    in L2; shared with the back end
  LevioFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
                work::Arena& keyframe_memory, const PoseGraph<P>& graph);

  FrameReport process(const FrameInput& input) override;

 private:
  void extract(Frame<P>& frame);
  void locate(Frame<P>& frame, FrameReport& report);
  bool is_keyframe(const Frame<P>& frame);

  FrontEndState<P> state_;
  InertialPart<P> inertial_;
  levio::ShiftRegister<P> random_;  ///< of both estimators
};

}  // namespace leviosim::vio
