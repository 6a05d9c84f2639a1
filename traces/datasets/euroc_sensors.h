// The sensors of the EuRoC MAV dataset, as its public sensor.yaml files state them (Burri et al.
// 2016; cam0: MT9M034, imu0: ADIS16448).
#pragma once

#include "traces/datasets/camera_model.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

/// Left camera: 752x480, 20 frames/s.
CameraModel euroc_cam0();

/// 200 Hz.
ImuModel euroc_imu0();

}  // namespace leviosim::traces
