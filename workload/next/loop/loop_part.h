// Loop closure as a part of a front end: which of its frames are looked at, when there is time for
// it, what of them may become a place, and the corrected pose that the frame reports.
#pragma once

#include "workload/next/loop/loop_closer.h"
#include "workload/vio/frame.h"

namespace leviosim::vio {

template <class P>
class LoopPart {
 public:
  /// @param state   outlives this
  /// @param memory  in L2
  LoopPart(const FrontEndState<P>& state, work::Arena& memory);

  /// A frame with a pose, before it may become a keyframe: landmarks that it then adds are seen by
  /// two keyframes only, and their depth is uncertain yet.
  /// Frames whose pose took the long way (EPnP, 8-point) have no time to spare.
  void follow(const Frame<P>& frame, FrameReport& report);
  /// The front end began another map.
  void expect_another_map() { closer_.expect_another_map(); }
  /// Moves the pose of the report from the odometry's world to the corrected one.
  void correct(const Frame<P>& frame, float dt, FrameReport& report);

 private:
  bool is_due(const Frame<P>& frame) const;
  LoopOutcome visit(const Frame<P>& frame);

  const FrontEndState<P>& state_;
  LoopCloser<P> closer_;
  int places_ = 0;  ///< that are kept
};

}  // namespace leviosim::vio
