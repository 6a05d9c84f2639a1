// The noise model of an inertial sensor as in EuRoC's sensor.yaml: white noise on each axis plus a
// bias that walks at random. Left out: scale factors of axes,
// misalignment, saturation, temperature.
#pragma once

namespace leviosim::traces {

struct ImuModel {
  double rate_hz = 0;
  double gyro_noise_density = 0;   ///< [rad/s/√Hz]
  double gyro_random_walk = 0;     ///< [rad/s²/√Hz]
  double accel_noise_density = 0;  ///< [m/s²/√Hz]
  double accel_random_walk = 0;    ///< [m/s³/√Hz]
  double accel_scale = 1;          ///< by which measured accelerations are multiplied
};

}  // namespace leviosim::traces
