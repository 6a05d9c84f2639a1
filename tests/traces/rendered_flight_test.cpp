// Flights along recorded motion: what is copied, what is drawn, and that both kinds of images give
// a pipeline the same. The recorded motion is that of AslFolder, with its camera of 32x24 pixels.
#include "traces/synthesis/rendered_flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/image_files.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/frame_range.h"
#include "traces/datasets/image_file.h"
#include "traces/datasets/image_source.h"
#include "traces/datasets/imu_samples.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/hall.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;
using testing::AslFolder;
using testing::contents;
using testing::expect_input_error;
using testing::TempFolder;

/// Coarse textures, quick to paint.
RenderedFlightOptions coarse() {
  RenderedFlightOptions options;
  options.texels = 8;
  return options;
}

TEST(RenderedFlight, PreparedImagesAreThoseOfFullOnes) {
  const AslFolder motion;
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  options.exposure_s = 0.01;
  options.illumination = true;
  write_rendered_flight(motion.root(), out / "full", options);
  const Dataset full = open_asl(out / "full");
  EXPECT_EQ(full.camera.width, 32);
  for (const ImageSize size : {ImageSize{16, 12}, {7, 5}, {32, 24}}) {
    options.prepared = size;
    options.overwrite = true;
    write_rendered_flight(motion.root(), out / "prepared", options);
    const Dataset prepared = open_asl(out / "prepared");
    const ImageSource a(full, size), b(prepared, size);
    ASSERT_EQ(a.size(), 6u);
    ASSERT_EQ(b.size(), 6u);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a.read(i).pixels, b.read(i).pixels) << size.width << " frame " << i;
      EXPECT_EQ(a.read(i).t_ns, b.read(i).t_ns);
    }
    EXPECT_EQ(a.intrinsics().cx, b.intrinsics().cx);
    EXPECT_EQ(a.intrinsics().fy, b.intrinsics().fy);
    expect_input_error([&] { ImageSource(prepared, {5, 5}); }, {"image size 5x5", "already"});
  }
}

TEST(RenderedFlight, SameBytesOnAnyNumberOfThreadsAndOthersFromOtherSeeds) {
  const AslFolder motion;
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  options.threads = 1;
  write_rendered_flight(motion.root(), out / "a", options);
  options.threads = 3;
  write_rendered_flight(motion.root(), out / "b", options);
  options.place.seed = 2;
  write_rendered_flight(motion.root(), out / "c", options);
  const auto a = contents(out / "a");
  EXPECT_EQ(a.size(), 5u + 6u);
  EXPECT_TRUE(a == contents(out / "b"));
  const auto c = contents(out / "c");
  const std::string image = "mav0/cam0/data/5000000000.png";
  EXPECT_NE(a.at(image), c.at(image));
  EXPECT_EQ(a.at("mav0/imu0/data.csv"), c.at("mav0/imu0/data.csv"));
}

TEST(RenderedFlight, RecordedStreamsAreCopiedExactly) {
  const AslFolder motion;
  const TempFolder out;
  write_rendered_flight(motion.root(), out / "a", coarse());
  for (const char* name : {"imu0/data.csv", "imu0/sensor.yaml", "cam0/sensor.yaml",
                           "state_groundtruth_estimate0/data.csv"})
    EXPECT_EQ(base::read_text_file(out / "a" / "mav0" / name),
              base::read_text_file(motion.mav0(name)))
        << name;
}

/// Pixel (x, y) as a ray through the camera model and the recorded pose finds it, without the
/// renderer: no noise, vignetting 0.3.
double expected_grey(const World& world, const CameraModel& camera,
                     const Eigen::Isometry3d& T_world_body, int x, int y) {
  const Eigen::Isometry3d T_world_camera = T_world_body * camera.T_body_camera;
  const Eigen::Vector3d ray =
      T_world_camera.linear() * camera.unproject({x, y}).homogeneous().eval();
  const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();
  const Eigen::Vector3f direction = ray.cast<float>();
  const auto pixel_angle = static_cast<float>(1 / std::sqrt(camera.fx * camera.fy));
  const double half_width = 0.5 * (camera.width - 1), half_height = 0.5 * (camera.height - 1);
  const double r2 = (std::pow(x - half_width, 2) + std::pow(y - half_height, 2)) /
                    (half_width * half_width + half_height * half_height);
  return (1 - 0.3 * r2) *
         World::grey(world.cast(origin, direction), origin, direction, pixel_angle);
}

TEST(RenderedFlight, PixelsSeeTheHallFromTheRecordedPose) {
  const AslFolder motion;
  motion.replace("cam0/sensor.yaml", "  data: [1, 0, 0, 0,", "  data: [1, 0, 0, 0.25,");
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  options.image_noise = 0;
  options.spot_px = 1;
  write_rendered_flight(motion.root(), out / "a", options);
  const Dataset data = open_asl(out / "a");
  EXPECT_EQ(data.camera.T_body_camera.translation().x(), 0.25);
  std::vector<Eigen::Vector3d> path;
  for (const GroundTruthPose& pose : data.ground_truth)
    path.push_back((pose.T_world_body * data.camera.T_body_camera).translation());
  const World world = make_hall(path, data.camera, {derive_seed(1, 0), 0.8, options.texels, 1});
  int differing = 0;
  for (int frame = 0; frame < AslFolder::kFrames; ++frame) {
    const cv::Mat image =
        tests::decoded(base::read_text_file(data.frames[static_cast<std::size_t>(frame)].path),
                       {data.camera.width, data.camera.height});
    const Eigen::Isometry3d& pose =
        data.ground_truth[static_cast<std::size_t>(10 + 10 * frame)].T_world_body;
    ASSERT_EQ(data.ground_truth[static_cast<std::size_t>(10 + 10 * frame)].t_ns,
              AslFolder::frame_ns(frame));
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        differing += std::abs(image.at<uchar>(y, x) -
                              std::min(255.0, expected_grey(world, data.camera, pose, x, y))) > 1.5;
  }
  // Rounding may turn a ray at an edge; a pose that is off would change most pixels.
  EXPECT_LE(differing, AslFolder::kFrames * 32 * 24 / 200);
}

TEST(RenderedFlight, WithoutRecordedFramesTheyFollowTheImu) {
  const AslFolder motion;
  fs::remove_all(motion.mav0("cam0/data"));
  fs::remove(motion.mav0("cam0/data.csv"));
  const TempFolder out;
  write_rendered_flight(motion.root(), out / "a", coarse());
  const Dataset data = open_asl(out / "a");
  ASSERT_EQ(data.frames.size(), 7u) << "from one period after the first IMU sample to the last";
  for (std::size_t i = 0; i < data.frames.size(); ++i) {
    EXPECT_EQ(data.frames[i].t_ns, AslFolder::frame_ns(static_cast<int>(i)));
    EXPECT_EQ(imu_batch(data, i).size(), 10u);
  }
}

TEST(RenderedFlight, ThereAreFramesOnlyWhereThereIsTruth) {
  const AslFolder motion;
  motion.remove_lines("state_groundtruth_estimate0/data.csv", 2, 12);  // up to 5 ms after frame 0
  const TempFolder out;
  write_rendered_flight(motion.root(), out / "a", coarse());
  const Dataset data = open_asl(out / "a");
  ASSERT_EQ(data.frames.size(), 5u);
  EXPECT_EQ(data.frames.front().t_ns, AslFolder::frame_ns(1));
}

TEST(RenderedFlight, ARangeHasTheImagesOfTheWhole) {
  const AslFolder motion;
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  write_rendered_flight(motion.root(), out / "all", options);
  const auto all = contents(out / "all");
  options.overwrite = true;
  const auto expect_frames = [&](const std::vector<FrameRange>& ranges,
                                 const std::vector<int>& frames) {
    options.frames = ranges;
    write_rendered_flight(motion.root(), out / "part", options);
    const auto part = contents(out / "part");
    EXPECT_EQ(part.size(), 5u + frames.size());
    for (const int frame : frames) {
      const std::string name = "mav0/cam0/data/" + image_name(AslFolder::frame_ns(frame));
      EXPECT_EQ(all.at(name), part.at(name));
    }
    EXPECT_EQ(open_asl(out / "part").frames.size(), frames.size());
  };
  expect_frames({{2, 4}}, {2, 3});
  expect_frames({{0, 1}, {3, 4}, {4, 6}}, {0, 3, 4, 5});
}

TEST(RenderedFlight, SaysWhenTheFramesOfTheWholeAreTaken) {
  const AslFolder motion;
  const std::vector<std::int64_t> stamps = rendered_frame_stamps(open_motion(motion.root()));
  ASSERT_EQ(stamps.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(stamps[i], AslFolder::frame_ns(i));
}

TEST(RenderedFlight, ASimulatedImuFollowsTheMotion) {
  const AslFolder motion;
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  options.imu = ImuSource::simulated;
  write_rendered_flight(motion.root(), out / "a", options);
  const Dataset data = open_asl(out / "a");
  ASSERT_EQ(data.imu.size(), 71u) << "stamps are the recorded ones";
  ASSERT_EQ(data.ground_truth.size(), data.imu.size());
  // The body of AslFolder flies 20 m/s along x and turns 10 rad/s.
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  for (std::size_t i = 20; i < 50; ++i) {
    gyro += (data.imu[i].gyro - data.ground_truth[i].bias_gyro) / 30;
    EXPECT_NEAR(data.ground_truth[i].velocity.x(), 20, 1e-3);
    EXPECT_NEAR((data.imu[i].accel - data.ground_truth[i].bias_accel).norm(), 9.81, 0.3);
  }
  EXPECT_NEAR(gyro.dot(Eigen::Vector3d(1, 2, 2) / 3), 10, 0.01);
  EXPECT_NE(data.ground_truth[0].bias_gyro, Eigen::Vector3d::Zero());

  fs::remove(motion.mav0("imu0/data.csv"));
  write_rendered_flight(motion.root(), out / "no_recording", coarse());
  EXPECT_EQ(open_asl(out / "no_recording").imu.size(), 71u);
  options.imu = ImuSource::recorded;
  expect_input_error([&] { write_rendered_flight(motion.root(), out / "b", options); },
                     {"imu0", "no data.csv"});
}

TEST(RenderedFlight, MotionBlurAndLightChangeThePictures) {
  const AslFolder motion;
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  write_rendered_flight(motion.root(), out / "plain", options);
  options.exposure_s = 0.02;
  write_rendered_flight(motion.root(), out / "blurred", options);
  options.exposure_s = 0;
  options.illumination = true;
  write_rendered_flight(motion.root(), out / "lit", options);
  const std::string image = "mav0/cam0/data/" + image_name(AslFolder::frame_ns(3));
  const auto plain = contents(out / "plain");
  EXPECT_NE(plain.at(image), contents(out / "blurred").at(image));
  EXPECT_NE(plain.at(image), contents(out / "lit").at(image));
}

TEST(RenderedFlight, RefusesWhatCannotBeRendered) {
  const TempFolder out;
  const auto refused = [&](const AslFolder& motion, const RenderedFlightOptions& options,
                           std::initializer_list<std::string> parts) {
    expect_input_error([&] { write_rendered_flight(motion.root(), out / "a", options); }, parts);
    EXPECT_TRUE(fs::is_empty(out.path()));
  };
  RenderedFlightOptions options = coarse();
  options.exposure_s = 0.2;
  refused(AslFolder(), options, {"exposure [s] 0.2", "0 to 0.05"});
  options = coarse();
  options.texels = 0;
  refused(AslFolder(), options, {"texel width [px] 0"});
  options = coarse();
  options.frames = {{4, 7}};
  refused(AslFolder(), options, {"4:7", "6 frames"});
  options.frames = {{2, 4}, {3, 5}};
  refused(AslFolder(), options, {"3:5", "does not lie behind"});
  options = coarse();
  options.prepared = ImageSize{64, 48};
  refused(AslFolder(), options, {"64x48", "32x24"});
  const AslFolder gap, untrue, single;
  gap.remove_lines("state_groundtruth_estimate0/data.csv", 20, 30);
  refused(gap, coarse(), {"state_groundtruth_estimate0/data.csv", "no pose for 0.155 s", "0.1 s"});
  fs::remove_all(untrue.mav0("state_groundtruth_estimate0"));
  refused(untrue, coarse(), {"state_groundtruth_estimate0/data.csv not found"});
  single.remove_lines("state_groundtruth_estimate0/data.csv", 3, 70);
  refused(single, coarse(), {"one pose"});
}

TEST(RenderedFlight, NeverReplacesTheRecordingItIsMadeFrom) {
  const AslFolder motion;
  RenderedFlightOptions options = coarse();
  options.overwrite = true;
  for (const fs::path& named : {motion.root(), motion.root() / "mav0"})
    expect_input_error([&] { write_rendered_flight(named, motion.root(), options); }, {"is read"});
  EXPECT_TRUE(fs::exists(motion.mav0("imu0/data.csv")));
}

TEST(RenderedFlight, NothingIsLeftOfAFailure) {
  const AslFolder motion;
  const TempFolder out;
  const auto stop = [](std::size_t done, std::size_t) {
    if (done == 2) throw std::runtime_error("stop");
  };
  EXPECT_THROW(write_rendered_flight(motion.root(), out / "a", coarse(), stop), std::runtime_error);
  EXPECT_TRUE(fs::is_empty(out.path()));
}

TEST(RenderedFlight, TheWholePathOfARecordingKeepsItsClearance) {
  const fs::path folder = testing::recorded_data() / "euroc_motion" / "MH_03_medium";
  if (!fs::exists(folder))
    GTEST_SKIP()
        << "no recorded motion: set LEVIOSIM_DATA to the folder that contains euroc_motion/";
  const MotionRecord record = open_motion(folder);
  std::vector<Eigen::Vector3d> path;
  for (const GroundTruthPose& pose : record.ground_truth)
    path.push_back((pose.T_world_body * record.camera.T_body_camera).translation());
  const World world = make_hall(path, record.camera, {5, 0.8, 10, 0});
  EXPECT_GT(world.objects().size(), 100u);
  double nearest = 1e9;
  for (std::size_t i = 0; i < path.size(); i += 3) {
    const Eigen::Vector3f p = path[i].cast<float>();
    const Eigen::Vector3f to_walls = (p - world.room().min).cwiseMin(world.room().max - p);
    nearest = std::min<double>(nearest, to_walls.minCoeff());
    for (const Box& box : world.objects())
      nearest =
          std::min<double>(nearest, Eigen::AlignedBox3f(box.min, box.max).exteriorDistance(p));
  }
  EXPECT_GE(nearest, 0.8);
}

TEST(RenderedFlight, OtherPlacesAreDrawnTheSameOnAnyNumberOfThreads) {
  const AslFolder motion;
  const TempFolder out;
  RenderedFlightOptions options = coarse();
  options.overwrite = true;
  const auto image_of = [&](const char* place, unsigned threads) {
    options.place = parse_place("a world", place);
    options.threads = threads;
    write_rendered_flight(motion.root(), out / "flight", options);
    return contents(out / "flight").at("mav0/cam0/data/5000000000.png");
  };
  const std::string hall = image_of("1", 1);
  for (const char* place : {"workshop:1", "1m:1"}) {
    const std::string image = image_of(place, 1);
    EXPECT_EQ(image, image_of(place, 3));
    EXPECT_NE(image, hall);
  }
  EXPECT_NE(image_of("workshop:1", 1), image_of("workshop:2", 1));
}

}  // namespace
}  // namespace leviosim::traces
