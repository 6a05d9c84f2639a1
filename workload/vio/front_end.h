// A front end as the odometry sees it: one frame, from pixels and IMU samples to a pose, on the
// cluster (paper Fig. 1, right side). The two that there are have rooms of their own: levio/ is the
// paper's, next/ ours.
#pragma once

#include "workload/vio/records.h"

namespace leviosim::vio {

template <class P>
class FrontEnd {
 public:
  FrontEnd() = default;
  FrontEnd(const FrontEnd&) = delete;  // its parts refer to each other
  FrontEnd& operator=(const FrontEnd&) = delete;
  virtual ~FrontEnd() = default;

  virtual FrameReport process(const FrameInput& input) = 0;
};

}  // namespace leviosim::vio
