// Recordings that are no plain ASL folders: each is made of the small ASL folder of the tests, whose
// content it must have, and then broken.
#include "traces/recordings/recording.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;
using testing::AslFolder;
using testing::expect_input_error;
using testing::TempFolder;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  outputs::write_file_atomically(file, text);
}

std::string seconds_text(std::int64_t t_ns) {
  return fmt::format("{}.{:09d}", t_ns / 1'000'000'000, t_ns % 1'000'000'000);
}

void expect_same_imu(const Dataset& a, const Dataset& b) {
  ASSERT_EQ(a.imu.size(), b.imu.size());
  for (std::size_t i = 0; i < a.imu.size(); ++i) {
    EXPECT_EQ(a.imu[i].t_ns, b.imu[i].t_ns);
    EXPECT_TRUE(a.imu[i].gyro.isApprox(b.imu[i].gyro, 1e-9));
    EXPECT_TRUE(a.imu[i].accel.isApprox(b.imu[i].accel, 1e-9));
  }
}

/// To 1e-5 m and rad: text files of some formats have fewer digits.
void expect_same_truth(const Dataset& a, const Dataset& b, double tolerance = 1e-5) {
  ASSERT_EQ(a.ground_truth.size(), b.ground_truth.size());
  for (std::size_t i = 0; i < a.ground_truth.size(); ++i) {
    EXPECT_EQ(a.ground_truth[i].t_ns, b.ground_truth[i].t_ns);
    const Eigen::Isometry3d difference =
        a.ground_truth[i].T_world_body.inverse() * b.ground_truth[i].T_world_body;
    EXPECT_LT(difference.translation().norm(), tolerance) << i;
    EXPECT_LT(Eigen::AngleAxisd(difference.linear()).angle(), tolerance) << i;
  }
}

Eigen::Isometry3d sloping_camera() {
  return Eigen::Translation3d(0.1, -0.2, 0.3) *
         Eigen::AngleAxisd(2, Eigen::Vector3d(1, -2, 2).normalized());
}

TEST(Recording, WhatIsNoRecordingIsRefusedWithWhatWasLookedFor) {
  const TempFolder folder;
  expect_input_error([&] { open_recording(folder.path() / "none"); }, {"no such folder"});
  expect_input_error([&] { open_recording(folder.path()); },
                     {"no recording of a known format; looked for mav0/ with dso/camchain.yaml "
                      "(TUM-VI), rgb.txt (TUM RGB-D), calib.txt with times.txt (KITTI odometry), "
                      "oxts/ with image_00/ or image_02/ (KITTI raw), mav0/, or cam0/ with imu0/ "
                      "(EuRoC (ASL))"});
  write(folder / "ros2/metadata.yaml", "x: 1\n");
  write(folder / "ros2/flight_0.db3", "x");
  for (const char* bag : {"ros2", "ros2/flight_0.db3"})
    expect_input_error([&] { open_recording(folder / bag); }, {bag, "rosbag_to_asl.py"});
}

TEST(Recording, AslFoldersAreReadAsBefore) {
  const AslFolder asl;
  OpenOptions options;
  options.frames = FrameRange{1, 3};
  const Dataset a = open_asl(asl.root(), options);
  for (const fs::path& named : {asl.root(), asl.mav0("")}) {
    const Dataset b = open_recording(named, options);
    EXPECT_EQ(b.frames.size(), 2u);
    EXPECT_EQ(b.frames.front().t_ns, a.frames.front().t_ns);
    expect_same_imu(a, b);
    expect_same_truth(a, b, 1e-12);
  }
  EXPECT_STREQ(format_of(asl.root()).name, "EuRoC (ASL)");
}

/// Kalibr's files instead of sensor.yaml, and the truth where TUM-VI has it.
class TumVi : public AslFolder {
 public:
  TumVi() {
    const Eigen::Matrix4d T = sloping_camera().inverse().matrix();
    std::string rows;
    for (int row = 0; row < 4; ++row)
      rows += fmt::format("  - [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n", T(row, 0), T(row, 1),
                          T(row, 2), T(row, 3));
    write(root() / "dso/camchain.yaml",
          "cam0:\n  T_cam_imu:\n" + rows +
              "  cam_overlaps: [1]\n  camera_model: pinhole\n"
              "  distortion_coeffs: [0.0034, 0.0007, -0.002, 0.0002]\n"
              "  distortion_model: equidistant\n  intrinsics: [20, 21, 15.5, 11.25]\n"
              "  resolution: [32, 24]\n  rostopic: /cam0/image_raw\n");
    write(root() / "dso/imu_config.yaml",
          "rostopic: /imu0\nupdate_rate: 200.0\naccelerometer_noise_density: 0.0028\n"
          "accelerometer_random_walk: 0.00086\ngyroscope_noise_density: 0.00016\n"
          "gyroscope_random_walk: 2.2e-05\n");
    fs::remove(mav0("cam0/sensor.yaml"));
    fs::remove(mav0("imu0/sensor.yaml"));
    fs::create_directories(mav0("mocap0"));
    write(mav0("mocap0/data.csv"),
          format_euroc(to_trajectory(read_ground_truth_csv(mav0("state_groundtruth_estimate0/data.csv")))));
    fs::remove_all(mav0("state_groundtruth_estimate0"));
  }
};

TEST(Recording, TumViHasTheCalibrationOfKalibr) {
  const AslFolder asl;
  const Dataset expected = open_asl(asl.root());
  const TumVi folder;
  const Dataset data = open_recording(folder.root());
  EXPECT_STREQ(format_of(folder.root()).name, "TUM-VI");
  EXPECT_EQ(data.camera.lens, Lens::equidistant);
  EXPECT_EQ(data.camera.k4, 0.0002);
  EXPECT_EQ(data.camera.p1, 0);
  EXPECT_EQ(data.camera.width, 32);
  EXPECT_NEAR(data.camera.rate_hz, 20, 1e-9);
  EXPECT_TRUE(data.camera.T_body_camera.isApprox(sloping_camera(), 1e-12));
  EXPECT_EQ(data.imu_model.rate_hz, 200);
  EXPECT_EQ(data.imu_model.gyro_random_walk, 2.2e-5);
  expect_same_imu(data, expected);
  expect_same_truth(data, expected, 1e-7);
  ASSERT_EQ(data.files.size(), 5u);
  EXPECT_EQ(data.files[2].name, "mocap0/data.csv") << "ground truth has a digest, too";
}

TEST(Recording, TumViShiftsFramesToTheTimesOfTheImu) {
  const TumVi folder;
  std::string text = base::read_text_file(folder.root() / "dso/camchain.yaml");
  write(folder.root() / "dso/camchain.yaml", text + "  timeshift_cam_imu: -0.0025\n");
  EXPECT_EQ(open_recording(folder.root()).frames[0].t_ns, AslFolder::frame_ns(0) - 2'500'000);
}

TEST(Recording, FaultsOfKalibrsFilesNameFileLineAndKey) {
  const auto broken = [](const char* from, const char* to, std::initializer_list<std::string> parts) {
    const TumVi folder;
    const fs::path file = folder.root() / "dso/camchain.yaml";
    std::string text = base::read_text_file(file);
    text.replace(text.find(from), std::string(from).size(), to);
    write(file, text);
    expect_input_error([&] { open_recording(folder.root()); }, parts);
  };
  broken("equidistant", "omni", {"camchain.yaml line 10", "cam0.distortion_model", "radtan, equidistant"});
  broken("  - [", "  - [9, ", {"camchain.yaml line 3", "cam0.T_cam_imu", "5 entries; expected 4"});
  broken("T_cam_imu", "T_imu_cam", {"cam0.T_cam_imu", "is missing"});
  const TumVi folder;
  fs::remove(folder.root() / "dso/imu_config.yaml");
  expect_input_error([&] { open_recording(folder.root()); }, {"dso/imu_config.yaml not found in"});
}

/// The streams of the ASL folder in the text files of TUM RGB-D, with the pictures as they are.
void write_tum_rgbd(const AslFolder& asl, const fs::path& folder, bool gyroscope) {
  const Dataset data = open_asl(asl.root());
  std::string frames = "# color images\n# timestamp filename\n", gyro = "# gyroscope\n", accel = gyro;
  fs::create_directories(folder / "rgb");
  for (const FrameRef& frame : data.frames) {
    const std::string name = "rgb/" + seconds_text(frame.t_ns) + ".png";
    frames += seconds_text(frame.t_ns) + " " + name + "\n";
    fs::copy_file(frame.path, folder / name);
  }
  for (const ImuSample& s : data.imu) {
    gyro += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", seconds_text(s.t_ns), s.gyro.x(),
                        s.gyro.y(), s.gyro.z());
    accel += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", seconds_text(s.t_ns), s.accel.x(),
                         s.accel.y(), s.accel.z());
  }
  Trajectory truth = to_trajectory(data.ground_truth);
  for (StampedPose& pose : truth)
    pose.T_world_body = pose.T_world_body * sloping_camera();  // the camera's
  CameraModel camera = data.camera;
  camera.T_body_camera = sloping_camera();
  write(folder / "cam0/sensor.yaml", format_camera_yaml(camera, "test"));
  write(folder / "rgb.txt", frames);
  write(folder / "accelerometer.txt", accel);
  write(folder / "groundtruth.txt", format_tum(truth));
  if (!gyroscope) return;
  write(folder / "gyroscope.txt", gyro);
  write(folder / "imu0/sensor.yaml", format_imu_yaml(data.imu_model, "test"));
}

TEST(Recording, TumRgbdWithAGyroscopeIsTheSameFlight) {
  const AslFolder asl;
  const TempFolder folder;
  write_tum_rgbd(asl, folder.path(), true);
  const Dataset expected = open_asl(asl.root());
  const Dataset data = open_recording(folder.path());
  ASSERT_EQ(data.frames.size(), expected.frames.size());
  EXPECT_EQ(data.frames[3].t_ns, AslFolder::frame_ns(3));
  EXPECT_EQ(data.frames[3].line, 6u);
  expect_same_imu(data, expected);
  expect_same_truth(data, expected, 1e-7);
  EXPECT_EQ(data.files.size(), 6u);
}

TEST(Recording, TumRgbdWithoutAGyroscopeHasNoImuAndTheCameraAsItsBody) {
  const AslFolder asl;
  const TempFolder folder;
  write_tum_rgbd(asl, folder.path(), false);
  const Dataset data = open_recording(folder.path());
  EXPECT_TRUE(data.imu.empty());
  EXPECT_TRUE(data.camera.T_body_camera.isApprox(Eigen::Isometry3d::Identity()));
  const Trajectory truth = read_tum(folder / "groundtruth.txt");
  ASSERT_EQ(data.ground_truth.size(), truth.size());
  EXPECT_TRUE(data.ground_truth[7].T_world_body.isApprox(truth[7].T_world_body, 1e-12));
}

TEST(Recording, FaultsOfTumRgbdNameFileAndLine) {
  const AslFolder asl;
  const TempFolder folder;
  write_tum_rgbd(asl, folder.path(), true);
  const auto broken = [&](const char* name, const std::string& text,
                          std::initializer_list<std::string> parts) {
    const std::string before = base::read_text_file(folder / name);
    write(folder / name, text);
    expect_input_error([&] { open_recording(folder.path()); }, parts);
    write(folder / name, before);
  };
  broken("rgb.txt", "# none\n", {"rgb.txt", "empty"});
  broken("rgb.txt", "1 a.png\n1 b.png\n", {"rgb.txt line 2", "repeats"});
  broken("rgb.txt", "5 a.png\n", {"rgb.txt line 1", "does not exist"});
  broken("gyroscope.txt", "5 0 0 2000\n", {"gyroscope.txt line 1", "beyond any gyroscope"});
  broken("gyroscope.txt", "99 0 0 0\n", {"gyroscope.txt", "no sample within the times of"});
  broken("accelerometer.txt", "5 0 0\n", {"accelerometer.txt line 1", "3 columns instead of 4"});
  fs::remove(folder / "accelerometer.txt");
  expect_input_error([&] { open_recording(folder.path()); }, {"accelerometer.txt not found in"});
  fs::remove(folder / "cam0/sensor.yaml");
  expect_input_error([&] { open_recording(folder.path()); },
                     {"cam0/sensor.yaml not found in", "hold no calibration"});
}

void copy_pictures(const Dataset& data, const fs::path& folder, int digits) {
  fs::create_directories(folder);
  for (std::size_t i = 0; i < data.frames.size(); ++i)
    fs::copy_file(data.frames[i].path, folder / fmt::format("{:0{}}.png", i, digits));
}

constexpr double kFocal = 20, kBaseline = 0.06;  // px, m

/// The projections of camera 0, and of one that lies a baseline to its right.
std::string projections(const char* of_0, const char* of_2) {
  return fmt::format("{}: 20 0 15.5 0 0 21 11.25 0 0 0 1 0\n{}: 20 0 15.5 {} 0 21 11.25 0 0 0 1 0\n",
                     of_0, of_2, -kFocal * kBaseline);
}

/// Cameras 0 fly along the truth: poses relative to the first, which looks along the world's y.
struct KittiOdometry {
  AslFolder asl;
  TempFolder folder;
  Dataset data = open_asl(asl.root());
  std::vector<Eigen::Isometry3d> poses;

  fs::path sequence() const { return folder / "sequences/07"; }
  explicit KittiOdometry(const char* images) {
    copy_pictures(data, sequence() / images, 6);
    std::string times, truth;
    for (std::size_t i = 0; i < data.frames.size(); ++i) {
      times += fmt::format("{:e}\n", static_cast<double>(i) * 0.05);
      poses.push_back(Eigen::Translation3d(0.1 * static_cast<double>(i), 0, static_cast<double>(i)) *
                      Eigen::AngleAxisd(0.02 * static_cast<double>(i), Eigen::Vector3d::UnitY()));
    }
    Trajectory trajectory;
    for (const Eigen::Isometry3d& pose : poses) trajectory.push_back({0, pose});
    write(sequence() / "calib.txt", projections("P0", "P2"));
    write(sequence() / "times.txt", times);
    write(folder / "poses/07.txt", format_kitti(trajectory));
  }
};

TEST(Recording, KittiOdometryHasPosesInAWorldWhoseZIsUp) {
  const KittiOdometry kitti("image_0");
  const Dataset data = open_recording(kitti.sequence());
  EXPECT_TRUE(data.imu.empty());
  EXPECT_EQ(data.camera.fy, 21);
  EXPECT_EQ(data.camera.cx, 15.5);
  EXPECT_EQ(data.camera.width, 32) << "of the pictures";
  EXPECT_NEAR(data.camera.rate_hz, 20, 1e-6);
  ASSERT_EQ(data.ground_truth.size(), 6u);
  const Eigen::Isometry3d pose = data.ground_truth[5].T_world_body;
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(0.5, 5, 0), 1e-8)) << "forward is y";
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-8))
      << "the camera's y is down";
  EXPECT_EQ(data.frames[5].t_ns, 250'000'000);
}

TEST(Recording, KittiColourCamerasLieBesideTheGreyOnes) {
  const KittiOdometry kitti("image_2");
  const Dataset data = open_recording(kitti.sequence());
  EXPECT_EQ(data.pictures, "image_2");
  EXPECT_TRUE(data.ground_truth[0].T_world_body.translation().isApprox(
      Eigen::Vector3d(kBaseline, 0, 0), 1e-8));
}

TEST(Recording, FaultsOfKittiOdometryNameFileLineAndKey) {
  const KittiOdometry kitti("image_0");
  const auto broken = [&](const fs::path& file, const std::string& text,
                          std::initializer_list<std::string> parts) {
    const std::string before = base::read_text_file(file);
    write(file, text);
    expect_input_error([&] { open_recording(kitti.sequence()); }, parts);
    write(file, before);
  };
  const fs::path calibration = kitti.sequence() / "calib.txt";
  broken(calibration, "P2: 1\n", {"calib.txt", "no line 'P0:' with 12 numbers"});
  broken(calibration, "\nP0: 1 2\n", {"calib.txt line 2, key 'P0'", "2 numbers; expected 12"});
  broken(calibration, "P0: x\n", {"calib.txt line 1, key 'P0'", "'x' is not a finite number"});
  broken(calibration, "P0: 0 0 0 0 0 1 0 0 0 0 1 0\n", {"focal lengths must be above 0"});
  broken(kitti.sequence() / "times.txt", "0\n", {"times.txt", "one time stamp is no rate"});
  broken(kitti.folder / "poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n", {"07.txt", "1 poses; expected 6"});
  fs::remove(kitti.sequence() / "image_0/000004.png");
  expect_input_error([&] { open_recording(kitti.sequence()); }, {"times.txt line 5", "000004.png"});
  fs::remove_all(kitti.folder / "poses");
  OpenOptions first;
  first.frames = FrameRange{0, 4};
  EXPECT_TRUE(open_recording(kitti.sequence(), first).ground_truth.empty());
}

constexpr double kLatitude = 49, kLongitude = 8.4;  // degrees

/// One row of the navigation system: on the globe, `p` from the first place. [m]
std::string oxts(const Eigen::Vector3d& p, double yaw, int i) {
  constexpr double kEarthM = 6378137, kDegree = 3.14159265358979323846 / 180;
  const double scale = std::cos(kLatitude * kDegree) * kEarthM;
  const double north = scale * std::log(std::tan((45 + kLatitude / 2) * kDegree)) + p.y();
  const double latitude = 2 * std::atan(std::exp(north / scale)) / kDegree - 90;
  std::string row = fmt::format("{:.14f} {:.14f} {:.9f} 0 0 {:.12f} 1 2 0 0 3", latitude,
                                kLongitude + p.x() / scale / kDegree, 100 + p.z(), yaw);
  row += fmt::format(" 0.1 0.2 {} 0 0 0 0.01 0.02 {} 0 0 0", 9.8 + i, 0.1 * i);
  return row + " 0.05 0.01 4 8 4 4 0\n";
}

struct KittiRaw {
  AslFolder asl;
  TempFolder folder;
  Dataset data = open_asl(asl.root());

  fs::path drive() const { return folder / "2011_09_26/2011_09_26_drive_0001_sync"; }
  KittiRaw() {
    copy_pictures(data, drive() / "image_00/data", 10);
    std::string times;
    for (int i = 0; i < 6; ++i) {
      times += fmt::format("2011-09-26 13:02:2{}.500000001\n", i);
      write(drive() / fmt::format("oxts/data/{:010}.txt", i),
            oxts({2.0 * i, 3.0 * i, 0.1 * i}, 0.1 * i, i));
    }
    write(drive() / "oxts/timestamps.txt", times);
    write(drive() / "image_00/timestamps.txt", times);
    const fs::path day = folder / "2011_09_26";
    write(day / "calib_cam_to_cam.txt", "calib_time: 09-Jan-2012 13:57:47\nR_rect_00: 1 0 0 0 1 0 0 0 1\n" +
                                            projections("P_rect_00", "P_rect_02"));
    // The scanner's x is forward and z up, as the vehicle's is.
    write(day / "calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.1 -0.3\n");
    write(day / "calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
  }
};

TEST(Recording, KittiRawHasTheNavigationSystemAsImuAndTruth) {
  const KittiRaw kitti;
  const Dataset data = open_recording(kitti.drive());
  ASSERT_EQ(data.frames.size(), 6u);
  EXPECT_EQ(data.frames[0].t_ns, 1317042140500000001) << "seconds since 1970";
  EXPECT_NEAR(data.imu_model.rate_hz, 1, 1e-9);
  ASSERT_EQ(data.imu.size(), 6u);
  EXPECT_TRUE(data.imu[3].accel.isApprox(Eigen::Vector3d(0.1, 0.2, 12.8)));
  EXPECT_TRUE(data.imu[3].gyro.isApprox(Eigen::Vector3d(0.01, 0.02, 0.3)));
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d pose = data.ground_truth[static_cast<std::size_t>(i)].T_world_body;
    EXPECT_LT((pose.translation() - Eigen::Vector3d(2.0 * i, 3.0 * i, 0.1 * i)).norm(), 1e-5);
    EXPECT_NEAR(std::atan2(pose(1, 0), pose(0, 0)), 0.1 * i, 1e-9);
  }
  EXPECT_TRUE(data.ground_truth[0].velocity.isApprox(Eigen::Vector3d(2, 1, 3))) << "east, north, up";
  const Eigen::Isometry3d camera = data.camera.T_body_camera;
  EXPECT_TRUE((camera.linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX(), 1e-9))
      << "it looks ahead";
  // -(T_velo_cam of the camera) in the scanner, minus the arm from the IMU to it.
  EXPECT_LT((camera.translation() - Eigen::Vector3d(0.3 + 0.8, 0 - 0.3, -0.1 + 0.8)).norm(), 1e-9);
  EXPECT_EQ(data.files.back().files.size(), 6u);
}

TEST(Recording, FaultsOfKittiRawNameFileLineAndKey) {
  const KittiRaw kitti;
  const auto broken = [&](const fs::path& file, const std::string& text,
                          std::initializer_list<std::string> parts) {
    const std::string before = base::read_text_file(file);
    write(file, text);
    expect_input_error([&] { open_recording(kitti.drive()); }, parts);
    write(file, before);
  };
  const fs::path day = kitti.folder / "2011_09_26";
  const fs::path times = kitti.drive() / "oxts/timestamps.txt";
  for (const char* text : {"2011-09-26 13:02\n", "2011-13-26 13:02:25.964389445\n",
                           "2011-02-30 13:02:25.964389445\n", "2011-09-26 24:02:25.964389445\n",
                           "2011-09-26 13:02:25.96438944x\n"})
    broken(times, text, {"timestamps.txt line 1", "not a time; expected as"});
  broken(times, "2011-09-26 13:02:25.964389445 1\n", {"3 columns instead of 2"});
  broken(day / "calib_velo_to_cam.txt", "R: 1 0 0 0 1 0 0 0 2\nT: 0 0 0\n",
         {"calib_velo_to_cam.txt, key 'R'", "no rotation"});
  broken(kitti.drive() / "oxts/data/0000000002.txt", "90 1\n", {"0000000002.txt line 1", "columns"});
  broken(kitti.drive() / "oxts/data/0000000002.txt",
         "90" + oxts({0, 0, 0}, 0, 0).substr(17), {"0000000002.txt line 1", "latitude"});
  fs::remove(kitti.drive() / "oxts/data/0000000005.txt");
  expect_input_error([&] { open_recording(kitti.drive()); }, {"0000000005.txt"});
}

}  // namespace
}  // namespace leviosim::traces
