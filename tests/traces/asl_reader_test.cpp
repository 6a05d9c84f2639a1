// open_asl: what a valid folder yields, and one test for each way a folder can be broken.
#include "traces/datasets/asl_reader.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/imu_gaps.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;
using testing::AslFolder;
using testing::expect_input_error;
using testing::TempFolder;

constexpr const char* kFrames = "cam0/data.csv";
constexpr const char* kImu = "imu0/data.csv";
constexpr const char* kTruth = "state_groundtruth_estimate0/data.csv";

void expect_broken(const AslFolder& folder, std::initializer_list<std::string> parts,
                   const OpenOptions& options = {}) {
  expect_input_error([&] { open_asl(folder.root(), options); }, parts);
}

TEST(AslReader, ReadsEveryStreamOfAValidFolder) {
  const AslFolder folder;
  const Dataset data = open_asl(folder.root());
  EXPECT_EQ(data.camera.fy, 21);
  EXPECT_EQ(data.imu_model.rate_hz, 200);
  ASSERT_EQ(data.frames.size(), 6u);
  EXPECT_EQ(data.frames[3].t_ns, AslFolder::frame_ns(3));
  EXPECT_EQ(data.frames[3].line, 5u) << "line 1 is the heading";
  EXPECT_EQ(data.frames[3].path, folder.image(3));
  ASSERT_EQ(data.imu.size(), 71u);
  EXPECT_EQ(data.imu[0].t_ns, AslFolder::kStartNs - 50'000'000);
  EXPECT_TRUE(data.imu[12].gyro.isApprox(Eigen::Vector3d(0.02, 0.2, -0.3)));
  EXPECT_TRUE(data.imu[12].accel.isApprox(Eigen::Vector3d(0.1, 9.81, 0.002)));
  ASSERT_EQ(data.ground_truth.size(), 71u);
  const GroundTruthPose& pose = data.ground_truth[14];
  const Eigen::Isometry3d expected =
      Eigen::Translation3d(0.4, 1, 2) * Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 2) / 3);
  EXPECT_TRUE(pose.T_world_body.isApprox(expected, 1e-9));
  EXPECT_EQ(pose.velocity, Eigen::Vector3d(20, 0, 0));
  EXPECT_EQ(pose.bias_gyro, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(pose.bias_accel, Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST(AslReader, OpensTheMav0FolderItself) {
  const AslFolder folder;
  EXPECT_EQ(open_asl(folder.root() / "mav0").frames.size(), 6u);
}

TEST(AslReader, GroundTruthIsOptional) {
  const AslFolder folder;
  fs::remove_all(folder.mav0("state_groundtruth_estimate0"));
  EXPECT_TRUE(open_asl(folder.root()).ground_truth.empty());
}

TEST(AslReader, AcceptsCarriageReturnsAndBlankLinesAtTheEnd) {
  const AslFolder folder;
  for (const char* name : {kFrames, kImu, kTruth}) {
    std::string text;
    for (const char c : base::read_text_file(folder.mav0(name)))
      text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    outputs::write_file_atomically(folder.mav0(name), "\xEF\xBB\xBF" + text + "\r\n \r\n\n");
  }
  const Dataset data = open_asl(folder.root());
  EXPECT_EQ(data.frames.size(), 6u);
  EXPECT_EQ(data.frames[0].path, folder.image(0));
  EXPECT_EQ(data.imu.size(), 71u);
}

TEST(AslReader, SelectsARangeOfFrames) {
  const AslFolder folder;
  OpenOptions options;
  options.frames = FrameRange{2, 4};
  const Dataset data = open_asl(folder.root(), options);
  ASSERT_EQ(data.frames.size(), 2u);
  EXPECT_EQ(data.frames[0].t_ns, AslFolder::frame_ns(2));
  EXPECT_EQ(data.frames[0].line, 4u);
  options.frames = FrameRange{2, 7};
  expect_broken(folder, {"frame range 2:7", "6 frames", "0:6"}, options);
}

TEST(AslReader, ChecksOnlyTheSelectedFramesAgainstImagesAndImu) {
  const AslFolder folder;
  fs::remove(folder.image(5));
  folder.remove_lines(kImu, 60, 13);  // the last 65 ms
  OpenOptions options;
  options.frames = FrameRange{0, 5};
  EXPECT_EQ(open_asl(folder.root(), options).frames.size(), 5u);
}

TEST(AslReader, MissingFolder) {
  const TempFolder empty;
  expect_input_error([&] { open_asl(empty / "nowhere"); }, {"nowhere", "no such folder"});
}

TEST(AslReader, MissingFilesSayWhatAnAslFolderHas) {
  for (const char* name : {"cam0/sensor.yaml", kFrames, "imu0/sensor.yaml", kImu}) {
    const AslFolder folder;
    fs::remove(folder.mav0(name));
    expect_broken(folder, {std::string(name) + " not found in", "mav0/{cam0,imu0}"});
  }
  const AslFolder folder;
  fs::remove(folder.mav0(kTruth));
  expect_broken(folder, {std::string(kTruth) + " not found in"});
}

TEST(AslReader, WrongNumberOfColumns) {
  const AslFolder folder;
  folder.set_line(kImu, 7, "4975000000,0,0,0,0,0");
  expect_broken(folder, {"imu0/data.csv line 7", "6 columns instead of 7"});
}

TEST(AslReader, CellsThatAreNoFiniteNumbers) {
  for (const char* text : {"abc", "nan", "inf", "-inf", "1e999", "", "1.5x", "0x10"}) {
    const AslFolder folder;
    folder.set_line(kImu, 7, fmt::format("4975000000,0,{},0,0,0,0", text));
    expect_broken(folder, {"imu0/data.csv line 7, column 3 (w_RS_S_y)",
                           fmt::format("'{}' is not a finite number", text)});
  }
}

TEST(AslReader, StampsThatAreNoIntegers) {
  for (const char* text : {"1.5e9", "-5", "12.0", "99999999999999999999"}) {
    const AslFolder folder;
    folder.set_line(kFrames, 3, fmt::format("{},a.png", text));
    expect_broken(folder, {"cam0/data.csv line 3, column 1 (timestamp [ns])", text, "integer"});
  }
}

TEST(AslReader, UnsortedStampsNameBothValues) {
  const AslFolder folder;
  folder.set_line(kImu, 7, "4969000000,0,0,0,0,0,0");
  expect_broken(folder,
                {"imu0/data.csv line 7", "4969000000", "lies before that of line 6", "4970000000"});
}

TEST(AslReader, DuplicateStampsNameBothLines) {
  for (const char* name : {kFrames, kImu, kTruth}) {
    const AslFolder folder;
    const std::string text = base::read_text_file(folder.mav0(name));
    const auto from = text.find('\n') + 1;
    const std::string row = text.substr(from, text.find('\n', from) - from);
    folder.set_line(name, 2, row + "\n" + row);
    expect_broken(folder, {std::string(name) + " line 3", "repeats that of line 2"});
  }
}

TEST(AslReader, BlankLineBetweenRows) {
  const AslFolder folder;
  folder.set_line(kImu, 7, "");
  expect_broken(folder, {"imu0/data.csv line 7", "blank line"});
}

/// Deadlines and energy follow from the rate.
TEST(AslReader, ARateThatContradictsTheStamps) {
  for (const char* rate : {"30", "22.1", "17.9", "10"}) {
    const AslFolder folder;
    folder.replace("cam0/sensor.yaml", "rate_hz: 20", fmt::format("rate_hz: {}", rate));
    expect_broken(folder, {"cam0/sensor.yaml line 13, key 'rate_hz'",
                           fmt::format("is {}; expected 20,", rate), "data.csv are 50 ms apart"});
  }
  const AslFolder near;
  near.replace("cam0/sensor.yaml", "rate_hz: 20", "rate_hz: 21.9");
  near.remove_lines(kFrames, 4, 1);
  EXPECT_EQ(open_asl(near.root()).frames.size(), 5u);
  const AslFolder two_frames;
  two_frames.remove_lines(kFrames, 3, 4);
  EXPECT_EQ(open_asl(two_frames.root()).frames.size(), 2u);
}

TEST(AslReader, AnImuRateThatContradictsTheStamps) {
  const AslFolder folder;
  folder.replace("imu0/sensor.yaml", "rate_hz: 200", "rate_hz: 100");
  expect_broken(folder, {"imu0/sensor.yaml line", "key 'rate_hz'", "is 100; expected 200,",
                         "imu0/data.csv are 5 ms apart"});
}

/// In g, in °/s, or of a sensor without power.
TEST(AslReader, UnitsOfTheImuThatCannotBe) {
  const auto scaled = [](double accel, double gyro) {
    std::vector<ImuSample> samples;
    for (int i = -10; i <= 60; ++i)
      samples.push_back({5'000'000'000 + i * 5'000'000, Eigen::Vector3d(0.1, 0.2, -0.3) * gyro,
                         Eigen::Vector3d(0.1, 9.81, 0) * accel});
    return format_imu_csv(samples);
  };
  const struct {
    double accel, gyro;
    const char *found, *hint;
  } cases[] = {{1 / 9.81, 1, "at most 1 m/s²", "are they in g?"},
               {0, 1, "at most 0 m/s²", "expected some 9.8 m/s²"},
               {1000, 1, "at least 9.81e+03 m/s²", "expected some 9.8 m/s²"},
               {1, 57.3, "at least 21.4 rad/s", "are they in °/s?"}};
  for (const auto& [accel, gyro, found, hint] : cases) {
    const AslFolder folder;
    outputs::write_file_atomically(folder.mav0(kImu), scaled(accel, gyro));
    expect_broken(folder, {"imu0/data.csv", found, hint});
  }
  const AslFolder right;
  outputs::write_file_atomically(right.mav0(kImu), scaled(1, 1));
  EXPECT_NO_THROW(open_asl(right.root()));
}

TEST(AslReader, ImuGapAboveTheLimit) {
  const AslFolder two_missing;
  two_missing.remove_lines(kImu, 30, 2);  // 15 ms, the default limit
  EXPECT_NO_THROW(open_asl(two_missing.root()));
  const AslFolder three_missing;
  three_missing.remove_lines(kImu, 30, 3);
  const Dataset whole = open_asl(AslFolder().root());
  const Dataset bridged = open_asl(three_missing.root());
  ASSERT_EQ(bridged.imu.size(), whole.imu.size());
  for (std::size_t i = 0; i < whole.imu.size(); ++i)
    EXPECT_EQ(bridged.imu[i].t_ns, whole.imu[i].t_ns);
  ASSERT_EQ(bridged.notes.size(), 1u);
  EXPECT_NE(bridged.notes[0].find("a gap of the IMU, the longest 20.0 ms"), std::string::npos);
  EXPECT_TRUE(whole.notes.empty());
  OpenOptions patient;
  patient.max_imu_gap_periods = 4;
  EXPECT_TRUE(open_asl(three_missing.root(), patient).notes.empty());
  const AslFolder many_missing;
  many_missing.remove_lines(kImu, 22, 22);
  expect_broken(many_missing, {"imu0/data.csv", "gap of 115.000 ms", "at most 100 ms",
                               "--frames 0:", " or --frames "});
}

TEST(AslReader, SamplesOfABridgeLieOnALine) {
  Dataset data;
  data.imu_model.rate_hz = 100;
  data.frames = {{0, {}, 0}, {100'000'000, {}, 0}};
  data.imu = {{0, {0, 0, 1}, {4, 0, 9}}, {80'000'000, {8, 0, 1}, {4, 0, 1}}};
  bridge_imu_gaps(data, 3);
  ASSERT_EQ(data.imu.size(), 9u);
  for (std::size_t k = 0; k < data.imu.size(); ++k) {
    EXPECT_EQ(data.imu[k].t_ns, static_cast<std::int64_t>(k) * 10'000'000);
    EXPECT_NEAR(data.imu[k].gyro.x(), static_cast<double>(k), 1e-12);
    EXPECT_NEAR(data.imu[k].accel.z(), 9 - static_cast<double>(k), 1e-12);
  }
}

TEST(AslReader, ClockAndScaleOfTheCalibrationAreApplied) {
  const Dataset plain = open_asl(AslFolder().root());
  const AslFolder folder;
  const auto append = [&](const char* name, const char* line) {
    const fs::path file = folder.mav0(name);
    outputs::write_file_atomically(file, base::read_text_file(file) + line);
  };
  append("cam0/sensor.yaml", "timeshift_cam_imu: -0.004\n");
  append("imu0/sensor.yaml", "accelerometer_scale: 0.98\n");
  const Dataset shifted = open_asl(folder.root());
  EXPECT_EQ(shifted.frames.front().t_ns, plain.frames.front().t_ns - 4'000'000);
  EXPECT_TRUE(shifted.imu[5].accel.isApprox(0.98 * plain.imu[5].accel, 1e-12));
  append("imu0/sensor.yaml", "accelerometer_scale: 9.8\n");
  expect_broken(folder, {"imu0/sensor.yaml", "accelerometer_scale"});
}

TEST(AslReader, ImuGapOutsideTheFramesDoesNotMatter) {
  const AslFolder folder;
  folder.remove_lines(kImu, 3, 6);
  EXPECT_NO_THROW(open_asl(folder.root()));
}

TEST(AslReader, FrameBeforeTheFirstImuSample) {
  const AslFolder tolerated;
  tolerated.remove_lines(kImu, 2, 11);  // starts 5 ms after the first frame
  EXPECT_NO_THROW(open_asl(tolerated.root()));
  const AslFolder folder;
  folder.remove_lines(kImu, 2, 12);
  expect_broken(folder, {"cam0/data.csv line 2", "5000000000", "0.0100 s before the first IMU"});
}

TEST(AslReader, FrameAfterTheLastImuSample) {
  const AslFolder folder;
  folder.remove_lines(kImu, 60, 13);
  expect_broken(folder, {"cam0/data.csv line 7", "5250000000", "s after the last IMU"});
}

TEST(AslReader, MissingImage) {
  const AslFolder folder;
  fs::remove(folder.image(3));
  expect_broken(folder, {"cam0/data.csv line 5", "5150000000.png", "does not exist"});
}

TEST(AslReader, RowWithoutFileName) {
  const AslFolder folder;
  folder.set_line(kFrames, 3, "5050000000,");
  expect_broken(folder, {"cam0/data.csv line 3, column 2 (filename)"});
}

TEST(AslReader, EmptySequences) {
  for (const char* name : {kFrames, kImu, kTruth}) {
    const AslFolder folder;
    outputs::write_file_atomically(folder.mav0(name), "#heading only\n");
    expect_broken(folder, {name, std::string_view(name) == kTruth ? "holds no row" : "empty"});
    outputs::write_file_atomically(folder.mav0(name), "");
    expect_broken(folder, {name, std::string_view(name) == kTruth ? "holds no row" : "empty"});
  }
}

TEST(AslReader, QuaternionNorm) {
  const auto row = [](double w) {
    return fmt::format("4955000000,0,0,0,{},0,0,0,0,0,0,0,0,0,0,0,0", w);
  };
  const AslFolder folder;
  folder.set_line(kTruth, 3, row(1.0009));
  EXPECT_EQ(open_asl(folder.root()).ground_truth[1].T_world_body.linear(),
            Eigen::Matrix3d::Identity());
  folder.set_line(kTruth, 3, row(0.9989));
  expect_broken(folder, {std::string(kTruth) + " line 3", "norm 0.998900"});
  folder.set_line(kTruth, 3, row(1.0011));
  expect_broken(folder, {std::string(kTruth) + " line 3", "norm 1.001100"});
}

/// Names of another column, or of another unit, are those of a table that is read wrongly.
TEST(AslReader, HeadingsThatContradictTheirColumns) {
  struct Case {
    const char* file;
    std::string heading;
    std::string place;
    std::string found;
    std::string expected;
  };
  const std::string gyro = "w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1]";
  const std::string accel = "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]";
  const std::string position = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]";
  for (const auto& [file, heading, place, found, expected] :
       {Case{kImu, "#timestamp [ns]," + accel + "," + gyro, "column 2", "a_RS_S_x [m s^-2]",
             "w_RS_S_x [rad s^-1]"},
        Case{kImu, "#timestamp [s]," + gyro + "," + accel, "column 1", "timestamp [s]",
             "timestamp [ns]"},
        Case{kImu, "# timestamp [ns],w_x,w_y,w_RS_S_z [deg s^-1]," + accel, "column 4",
             "w_RS_S_z [deg s^-1]", "w_RS_S_z [rad s^-1]"},
        Case{kTruth, position + ", q_x, q_y, q_z, q_w", "column 5", "q_x", "q_RS_w"},
        Case{kTruth, position + ", q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [km s^-1]",
             "column 9", "v_RS_R_x [km s^-1]", "v_RS_R_x [m s^-1]"},
        Case{kFrames, "#filename,timestamp [ns]", "column 1", "filename", "timestamp [ns]"}}) {
    const AslFolder folder;
    folder.set_line(file, 1, heading);
    expect_broken(folder, {std::string(file) + " line 1, " + place, "found '" + found + "'",
                           "expected '" + expected + "'"});
  }
}

TEST(AslReader, HeadingsThatSayTheSameOrNothing) {
  for (const char* heading : {"#foo,bar,baz", "# IMU of a flight", "#timestamp", "#",
                              "#timestamp[ns],w.x [rad/s],w.y [rad/sec],w.z [],a.x [m/s^2],a.y,a.z "
                              "[m/s2],temperature [K]",
                              "#t [s],gyro x [deg/s],gyro y,gyro z,acc x [g],acc y,acc z"}) {
    const AslFolder folder;
    folder.set_line(kImu, 1, heading);
    EXPECT_EQ(open_asl(folder.root()).imu.size(), 71u) << heading;
  }
  const AslFolder none;
  none.remove_lines(kImu, 1, 1);
  EXPECT_EQ(open_asl(none.root()).imu.size(), 71u);
  const AslFolder of_tum_vi;
  of_tum_vi.set_line(kTruth, 1,
                     "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], "
                     "q_RS_x [], q_RS_y [], q_RS_z []");
  EXPECT_EQ(open_asl(of_tum_vi.root()).ground_truth.size(), 71u);
}

TEST(AslReader, RecordedFlight) {
  const fs::path folder = testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const Dataset data = open_asl(folder);
  EXPECT_EQ(data.frames.size(), 300u);
  EXPECT_EQ(data.imu.size(), 3201u);
  EXPECT_EQ(data.ground_truth.size(), 3201u);
  EXPECT_EQ(data.camera.fx, 458.654);
  EXPECT_EQ(data.camera.width, 752);
  EXPECT_EQ(data.frames.front().t_ns, 1403636584763555584);
}

}  // namespace
}  // namespace leviosim::traces
