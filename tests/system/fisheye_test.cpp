// Folders as other data sets have them. As TUM-VI: an equidistant lens, 512x512, calibrated by
// Kalibr, and poses of a motion capture; it is read and undistorted, and the odometry is as
// accurate as through a lens without distortion. As TUM RGB-D: the same flight, or one without IMU.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/base/error.h"
#include "tests/support/scratch.h"
#include "tools/app/run/simulate.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/euroc_sensors.h"
#include "traces/datasets/sensor_yaml.h"
#include "traces/synthesis/synthetic.h"
#include "traces/trajectories/trajectory_file.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

/// As wide as leviosim draws: the corners of the image are seen at 76 degrees.
traces::CameraModel fisheye() {
  traces::CameraModel camera = traces::euroc_cam0();
  camera.lens = traces::Lens::equidistant;
  camera.width = camera.height = 512;
  camera.fx = camera.fy = 270;
  camera.cx = 254.9;
  camera.cy = 256.9;
  camera.k1 = 0.0034823894022493434;
  camera.k2 = 0.0007150348452162257;
  camera.p1 = camera.p2 = 0;
  camera.k3 = -0.0020532361418706202;
  camera.k4 = 0.00020293673591811182;
  return camera;
}

traces::CameraModel without_distortion(traces::CameraModel camera) {
  camera.lens = traces::Lens::radial_tangential;
  camera.k1 = camera.k2 = camera.k3 = camera.k4 = 0;
  return camera;
}

void draw(const fs::path& folder, const traces::CameraModel& camera) {
  traces::SyntheticOptions options;
  options.duration_s = 8;
  options.texel_m = 0.01;
  options.camera = camera;
  traces::write_synthetic_flight(folder, options);
}

/// The first 8 columns of the truth, in the place where TUM-VI has them.
void as_motion_capture(const fs::path& mav0) {
  std::string text =
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], "
      "q_RS_x [], q_RS_y [], q_RS_z []\n";
  for (const traces::GroundTruthPose& pose :
       traces::read_ground_truth_csv(mav0 / traces::kTruthCsv)) {
    const Eigen::Quaterniond q(pose.T_world_body.linear());
    const Eigen::Vector3d p = pose.T_world_body.translation();
    text += fmt::format("{},{},{},{},{},{},{},{}\n", pose.t_ns, p.x(), p.y(), p.z(), q.w(), q.x(),
                        q.y(), q.z());
  }
  fs::remove_all((mav0 / traces::kTruthCsv).parent_path());
  tests::write_text(mav0 / traces::kMocapCsv, text);
}

std::string in_seconds(std::int64_t t_ns) {
  return fmt::format("{}.{:09d}", t_ns / 1'000'000'000, t_ns % 1'000'000'000);
}

/// Kalibr's two files in the place of both sensor.yaml.
void as_calibrated_by_kalibr(const fs::path& folder) {
  const traces::CameraModel camera = traces::read_camera_model(folder / "mav0/cam0/sensor.yaml");
  const traces::ImuModel imu = traces::read_imu_model(folder / "mav0/imu0/sensor.yaml");
  const Eigen::Matrix4d T = camera.T_body_camera.inverse().matrix();
  std::string text = "cam0:\n  T_cam_imu:\n";
  for (int row = 0; row < 4; ++row)
    text += fmt::format("  - [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n", T(row, 0), T(row, 1),
                        T(row, 2), T(row, 3));
  text += fmt::format(
      "  camera_model: pinhole\n  distortion_model: equidistant\n"
      "  distortion_coeffs: [{}, {}, {}, {}]\n  intrinsics: [{}, {}, {}, {}]\n"
      "  resolution: [{}, {}]\n",
      camera.k1, camera.k2, camera.k3, camera.k4, camera.fx, camera.fy, camera.cx, camera.cy,
      camera.width, camera.height);
  tests::write_text(folder / "dso/camchain.yaml", text);
  tests::write_text(
      folder / "dso/imu_config.yaml",
      fmt::format("update_rate: {}\ngyroscope_noise_density: {}\ngyroscope_random_walk: {}\n"
                  "accelerometer_noise_density: {}\naccelerometer_random_walk: {}\n",
                  imu.rate_hz, imu.gyro_noise_density, imu.gyro_random_walk,
                  imu.accel_noise_density, imu.accel_random_walk));
  fs::remove(folder / "mav0/cam0/sensor.yaml");
  fs::remove(folder / "mav0/imu0/sensor.yaml");
}

/// The text files of TUM RGB-D beside the pictures of an ASL folder, without the truth.
void as_tum_rgbd(const fs::path& asl, const fs::path& folder) {
  const traces::Dataset data = traces::open_asl(asl);
  std::string frames, gyro, accel;
  for (const traces::FrameRef& frame : data.frames)
    frames += in_seconds(frame.t_ns) + " " + fs::absolute(frame.path).string() + "\n";
  const auto add = [](std::string& text, std::int64_t t_ns, const Eigen::Vector3d& v) {
    text += fmt::format("{} {} {} {}\n", in_seconds(t_ns), v.x(), v.y(), v.z());
  };
  for (const traces::ImuSample& sample : data.imu) {
    add(gyro, sample.t_ns, sample.gyro);
    add(accel, sample.t_ns, sample.accel);
  }
  tests::write_text(folder / "rgb.txt", frames);
  tests::write_text(folder / "gyroscope.txt", gyro);
  tests::write_text(folder / "accelerometer.txt", accel);
  for (const char* sensor : {"cam0/sensor.yaml", "imu0/sensor.yaml"})
    tests::write_text(folder / sensor, tests::read_text(asl / "mav0" / sensor));
}

RunResult native(const fs::path& folder, const char* profile) {
  RunRequest request;
  request.data = folder.string();
  request.profile = profile;
  request.native = true;
  return simulate(request, [](const Progress&) {});
}

double accuracy_through(const fs::path& folder, const char* profile) {
  const RunResult run = native(folder, profile);
  EXPECT_TRUE(run.ate) << run.not_comparable;
  return run.ate ? run.ate->translation.rmse : 1e9;
}

TEST(Fisheye, AFolderAsOfTumViIsAsAccurateAsAPinholeCamera) {
  const tests::Scratch folder;
  draw(folder / "fisheye", fisheye());
  draw(folder / "pinhole", without_distortion(fisheye()));
  as_motion_capture(folder / "fisheye/mav0");
  fs::copy(folder / "fisheye", folder / "taken-as-pinhole", fs::copy_options::recursive);
  as_calibrated_by_kalibr(folder / "fisheye");
  const traces::TrajectoryFile truth = traces::read_trajectory(folder / "fisheye");
  EXPECT_EQ(truth.format, traces::TrajectoryFormat::euroc);
  EXPECT_GT(truth.poses.size(), 1000u);
  for (const char* profile : {"next"}) {  // levio diverges on single flights through either lens
    const double through_fisheye = accuracy_through(folder / "fisheye", profile);
    const double through_pinhole = accuracy_through(folder / "pinhole", profile);
    RecordProperty(std::string(profile) + "_fisheye_mm", static_cast<int>(1e3 * through_fisheye));
    RecordProperty(std::string(profile) + "_pinhole_mm", static_cast<int>(1e3 * through_pinhole));
    EXPECT_LT(through_fisheye, 2 * through_pinhole + 0.02) << profile;
  }
  // Taken for the picture of a pinhole camera, it would be far off.
  tests::write_text(folder / "taken-as-pinhole/mav0/cam0/sensor.yaml",
                    traces::format_camera_yaml(without_distortion(fisheye()), "wrong"));
  EXPECT_GT(accuracy_through(folder / "taken-as-pinhole", "next"),
            2 * accuracy_through(folder / "fisheye", "next"));
}

TEST(Recordings, AFlightInTheFilesOfTumRgbdIsTheSameFlight) {
  const tests::Scratch folder;
  traces::SyntheticOptions options;
  options.duration_s = 2;
  options.texel_m = 0.02;
  traces::write_synthetic_flight(folder / "asl", options);
  as_tum_rgbd(folder / "asl", folder / "rgbd");
  const auto poses = [&](const char* name, const char* profile) {
    return traces::format_tum(native(folder / name, profile).trajectory);
  };
  const std::string expected = poses("asl", "levio");
  EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 20);
  EXPECT_EQ(poses("rgbd", "levio"), expected);

  fs::remove(folder / "rgbd/gyroscope.txt");
  try {
    poses("rgbd", "levio");
    ADD_FAILURE() << "levio has no use for a recording without gyroscope";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("has no gyroscope"), std::string::npos);
  }
  const std::string blind = poses("rgbd", "levio-no-imu");
  EXPECT_EQ(std::count(blind.begin(), blind.end(), '\n'),
            std::count(expected.begin(), expected.end(), '\n'));
}

}  // namespace
}  // namespace leviosim::tools
