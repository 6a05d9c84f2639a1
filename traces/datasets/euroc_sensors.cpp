#include "traces/datasets/euroc_sensors.h"

#include <fmt/core.h>

namespace leviosim::traces {

CameraModel euroc_cam0() {
  CameraModel camera;
  camera.fx = 458.654;
  camera.fy = 457.296;
  camera.cx = 367.215;
  camera.cy = 248.375;
  camera.k1 = -0.28340811;
  camera.k2 = 0.07395907;
  camera.p1 = 0.00019359;
  camera.p2 = 1.76187114e-05;
  camera.width = 752;
  camera.height = 480;
  camera.rate_hz = 20;
  Eigen::Matrix4d matrix;
  matrix << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,            //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,        //
      0, 0, 0, 1;
  camera.T_body_camera = Eigen::Isometry3d(matrix);
  return camera;
}

ImuModel euroc_imu0() {
  ImuModel imu;
  imu.rate_hz = 200;
  imu.gyro_noise_density = 1.6968e-4;
  imu.gyro_random_walk = 1.9393e-5;
  imu.accel_noise_density = 2.0e-3;
  imu.accel_random_walk = 3.0e-3;
  return imu;
}

}  // namespace leviosim::traces
