// The camera that all kernels share, as plain numbers.
#pragma once

namespace leviosim::vio {

/// Pinhole camera without distortion (images arrive undistorted). Units: pixels.
struct PinholeCamera {
  float fx, fy, cx, cy;
};

}  // namespace leviosim::vio
