#include "traces/datasets/asl_writer.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace leviosim::traces {
namespace {

/// T_BS in the ASL layout.
std::string format_extrinsics(const Eigen::Isometry3d& transform) {
  std::string out = "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      fmt::format_to(std::back_inserter(out), "{}{}", transform.matrix()(row, column),
                     column < 3 ? ", " : "");
    out += row < 3 ? ",\n         " : "]\n";
  }
  return out;
}

void append(std::string& out, const Eigen::Vector3d& vector) {
  constexpr double kPrintsAsZero = 0.5e-10;
  for (const double value : vector)
    fmt::format_to(std::back_inserter(out), ",{:.10f}",
                   std::abs(value) < kPrintsAsZero ? 0.0 : value);
}

}  // namespace

std::string format_camera_yaml(const CameraModel& camera, const std::string& comment) {
  const bool radial = camera.lens == Lens::radial_tangential;
  std::string out = fmt::format(
      "sensor_type: camera\ncomment: {}\n\n# Camera frame to body frame.\n{}\nrate_hz: {}\n"
      "resolution: [{}, {}]\ncamera_model: pinhole\nintrinsics: [{}, {}, {}, {}] # fu, fv, cu, cv\n"
      "distortion_model: {}\ndistortion_coefficients: [{}, {}, {}, {}]\n",
      comment, format_extrinsics(camera.T_body_camera), camera.rate_hz, camera.width, camera.height,
      camera.fx, camera.fy, camera.cx, camera.cy, radial ? "radial-tangential" : "equidistant",
      camera.k1, camera.k2, radial ? camera.p1 : camera.k3, radial ? camera.p2 : camera.k4);
  if (camera.prepared)
    out += "prepared: true # undistorted and decimated: leviosim uses the images as they are\n";
  return out;
}

std::string format_imu_yaml(const ImuModel& imu, const std::string& comment) {
  return fmt::format(
      "sensor_type: imu\ncomment: {}\n\n# The body frame is the IMU frame.\n{}\nrate_hz: {}\n\n"
      "gyroscope_noise_density: {}     # [rad/s/sqrt(Hz)]\n"
      "gyroscope_random_walk: {}       # [rad/s^2/sqrt(Hz)]\n"
      "accelerometer_noise_density: {} # [m/s^2/sqrt(Hz)]\n"
      "accelerometer_random_walk: {}   # [m/s^3/sqrt(Hz)]\n",
      comment, format_extrinsics(Eigen::Isometry3d::Identity()), imu.rate_hz,
      imu.gyro_noise_density, imu.gyro_random_walk, imu.accel_noise_density, imu.accel_random_walk);
}

std::string format_ground_truth_yaml(const std::string& comment) {
  return fmt::format("sensor_type: visual-inertial\ncomment: {}\n\n{}", comment,
                     format_extrinsics(Eigen::Isometry3d::Identity()));
}

std::string image_name(std::int64_t t_ns) { return fmt::format("{}.png", t_ns); }

std::string format_frames_csv(const std::vector<std::int64_t>& stamps_ns) {
  std::string out = "#timestamp [ns],filename\n";
  for (const std::int64_t t_ns : stamps_ns) out += fmt::format("{},{}\n", t_ns, image_name(t_ns));
  return out;
}

std::string format_imu_csv(const std::vector<ImuSample>& samples) {
  std::string out =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuSample& sample : samples) {
    out += fmt::format("{}", sample.t_ns);
    append(out, sample.gyro);
    append(out, sample.accel);
    out += '\n';
  }
  return out;
}

std::string format_ground_truth_csv(const std::vector<GroundTruthPose>& poses) {
  std::string out =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
      "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], "
      "b_a_RS_S_z [m s^-2]\n";
  for (const GroundTruthPose& pose : poses) {
    Eigen::Quaterniond q(pose.T_world_body.linear());
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    out += fmt::format("{}", pose.t_ns);
    append(out, pose.T_world_body.translation());
    out += fmt::format(",{:.10f}", q.w());
    append(out, q.vec());
    append(out, pose.velocity);
    append(out, pose.bias_gyro);
    append(out, pose.bias_accel);
    out += '\n';
  }
  return out;
}

}  // namespace leviosim::traces
