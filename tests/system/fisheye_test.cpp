// A folder as TUM-VI has them: an equidistant lens, 512x512, and poses of a motion capture. It is
// read and undistorted, and the odometry is as accurate as through a lens without distortion.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "tests/support/scratch.h"
#include "tools/app/run/simulate.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/asl_writer.h"
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

double accuracy_through(const fs::path& folder, const std::string& profile) {
  RunRequest request;
  request.data = folder.string();
  request.profile = profile;
  request.native = true;
  const RunResult run = simulate(request, [](const Progress&) {});
  EXPECT_TRUE(run.ate) << run.not_comparable;
  return run.ate ? run.ate->translation.rmse : 1e9;
}

TEST(Fisheye, AFolderAsOfTumViIsAsAccurateAsAPinholeCamera) {
  const tests::Scratch folder;
  draw(folder / "fisheye", fisheye());
  draw(folder / "pinhole", without_distortion(fisheye()));
  as_motion_capture(folder / "fisheye/mav0");
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
  fs::copy(folder / "fisheye", folder / "taken-as-pinhole", fs::copy_options::recursive);
  tests::write_text(folder / "taken-as-pinhole/mav0/cam0/sensor.yaml",
                    traces::format_camera_yaml(without_distortion(fisheye()), "wrong"));
  EXPECT_GT(accuracy_through(folder / "taken-as-pinhole", "next"),
            2 * accuracy_through(folder / "fisheye", "next"));
}

}  // namespace
}  // namespace leviosim::tools
