// The motion behind recorded ground truth: a spline through its positions and one through its
// quaternions, brought to unit length. Both have two continuous derivatives, so that a camera can
// look along it and an ideal IMU can feel it. The velocities and biases of the recording are not
// used: in some recordings they are finite differences and zeros.
//
// Images are drawn along the interpolating spline, which meets every recorded pose. For a simulated
// IMU the recording must be smoothed first: positions written with 1e-6 m at 200 Hz have a rounding
// noise that double differentiation turns into 0.03 m/s², as much as the noise of the sensor.
#pragma once

#include <cstdint>
#include <span>

#include "traces/datasets/dataset.h"
#include "traces/synthesis/motion.h"
#include "traces/synthesis/smoothing_spline.h"

namespace leviosim::traces {

class RecordedMotion : public Motion {
 public:
  /// Half of the amplitude of what oscillates at this frequency survives the smoothing. [Hz]
  static constexpr double kSmoothHz = 20;

  /// At least two poses. Time 0 of the motion is `origin_ns`.
  RecordedMotion(std::span<const GroundTruthPose> poses, std::int64_t origin_ns,
                 double half_gain_hz = SmoothingSpline::kInterpolate);

  /// Before and after the recording the body drifts on at the velocity of its ends.
  MotionState at(double t_s) const override;

 private:
  SmoothingSpline spline_;  // columns: position x y z, quaternion x y z w
};

}  // namespace leviosim::traces
