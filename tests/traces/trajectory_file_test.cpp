#include "traces/trajectories/trajectory_file.h"
#include "traces/trajectories/kitti_files.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"

namespace leviosim::traces {
namespace {

using testing::AslFolder;
using testing::expect_input_error;
using testing::TempFolder;

constexpr const char* kTum = "1.5 1 2 3 0 0 0 1\n2.5 2 2 3 0 0 0.6 0.8\n";
constexpr const char* kKitti =
    "1 0 0 1 0 1 0 2 0 0 1 3\n"
    "2.8e-01 -9.6e-01 0 2 9.6e-01 2.8e-01 0 2 0 0 1 3\n";

class TrajectoryFiles : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    outputs::write_file_atomically(folder_ / name, text);
    return folder_ / name;
  }
  TempFolder folder_;
};

TEST_F(TrajectoryFiles, AreToldApartByTheirContent) {
  EXPECT_EQ(detect_format(write("a.txt", kTum)), TrajectoryFormat::tum);
  EXPECT_EQ(detect_format(write("b.txt", std::string("# comment\n") + kTum)),
            TrajectoryFormat::tum);
  EXPECT_EQ(detect_format(write("c.tum", kKitti)), TrajectoryFormat::kitti);
  const AslFolder flight;
  EXPECT_EQ(detect_format(flight.mav0("state_groundtruth_estimate0/data.csv")),
            TrajectoryFormat::euroc);
}

TEST_F(TrajectoryFiles, OfNoFormatAreRefused) {
  expect_input_error([&] { detect_format(write("a", "# x\n1 2 3\n")); },
                     {"a line 2", "3 columns separated by blanks", "8 (TUM)", "12 (KITTI)"});
  expect_input_error([&] { detect_format(write("a", "1,2,3,4\n")); },
                     {"a line 1", "4 columns separated by commas", "17"});
  expect_input_error([&] { detect_format(write("a", "# only\n")); }, {"a", "no row"});
  expect_input_error([&] { detect_format(write("a", "")); }, {"a", "no row"});
  expect_input_error([&] { read_trajectory(folder_ / "none"); }, {"none", "no such file"});
  expect_input_error([&] { parse_trajectory_format("kiti"); }, {"'kiti'", "tum, euroc, kitti"});
}

TEST_F(TrajectoryFiles, TheSamePosesInTumAndKitti) {
  const TrajectoryFile tum = read_trajectory(write("a.tum", kTum));
  const TrajectoryFile numbered = read_trajectory(write("a.kitti", kKitti));
  ReadOptions options;
  options.times = write("times.txt", "1.5\n2.5e+00\n");
  const TrajectoryFile timed = read_trajectory(folder_ / "a.kitti", options);
  EXPECT_EQ(tum.stamps, Stamps::time);
  EXPECT_EQ(numbered.stamps, Stamps::pose_number);
  EXPECT_EQ(timed.stamps, Stamps::time);
  ASSERT_EQ(numbered.poses.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(numbered.poses[i].t_ns, static_cast<std::int64_t>(i));
    EXPECT_EQ(timed.poses[i].t_ns, tum.poses[i].t_ns);
    EXPECT_TRUE(timed.poses[i].T_world_body.isApprox(tum.poses[i].T_world_body, 1e-12));
  }
}

TEST_F(TrajectoryFiles, WrittenInAnyFormatAreReadAgain) {
  const TrajectoryFile tum = read_trajectory(write("a.tum", kTum));
  ReadOptions options;
  options.times = write("times.txt", "1.5\n2.5\n");
  for (const char* format : {"tum", "euroc", "kitti"}) {
    const TrajectoryFile again =
        read_trajectory(write("b", trajectory_text(format, tum.poses)), options);
    EXPECT_EQ(again.format, parse_trajectory_format(format));
    ASSERT_EQ(again.poses.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(again.poses[i].t_ns, tum.poses[i].t_ns);
      EXPECT_TRUE(again.poses[i].T_world_body.isApprox(tum.poses[i].T_world_body, 1e-8)) << format;
    }
  }
  EXPECT_EQ(trajectory_text("jsonl", {tum.poses[1]}),
            "{\"t_ns\":2500000000,\"p\":[2.000000000,2.000000000,3.000000000],"
            "\"q\":[0.800000000,0.000000000,0.000000000,0.600000000]}\n");
  expect_input_error([] { trajectory_text("json", {}); }, {"'json'", "tum, euroc, kitti, jsonl"});
}

TEST_F(TrajectoryFiles, AForcedFormatIsThatOfTheFile) {
  ReadOptions options;
  options.format = TrajectoryFormat::kitti;
  expect_input_error([&] { read_trajectory(write("a", kTum), options); },
                     {"a line 1", "8 columns instead of 12"});
  options.format = TrajectoryFormat::euroc;
  expect_input_error([&] { read_trajectory(write("a", kTum), options); },
                     {"a line 1", "instead of 8"});
}

TEST_F(TrajectoryFiles, BrokenKittiRows) {
  const auto expect = [&](const std::string& text, std::initializer_list<std::string> parts) {
    const auto file = write("k.txt", text);
    expect_input_error([&] { read_kitti_poses(file); }, parts);
  };
  expect("1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 nan 0 0 1 3\n",
         {"k.txt line 2, column 8 (ty)", "'nan'"});
  expect("1 0 0 1 0 1 0 2 0 0 1\n", {"k.txt line 1", "11 columns instead of 12"});
  expect("2 0 0 1 0 1 0 2 0 0 1 3\n", {"k.txt line 1", "no rotation"});
  expect("1 0 0 1 0 1 0 2 0 0 -1 3\n", {"k.txt line 1", "reflection"});
  expect("1e300 0 0 1 0 1 0 2 0 0 1 3\n", {"k.txt line 1", "no rotation"});
  expect("\n", {"k.txt", "no pose"});
}

TEST_F(TrajectoryFiles, TimesBelongToThePoses) {
  const auto kitti = write("k.txt", kKitti);
  const auto expect = [&](const std::string& times, std::initializer_list<std::string> parts) {
    ReadOptions options;
    options.times = write("times.txt", times);
    expect_input_error([&] { read_trajectory(kitti, options); }, parts);
  };
  expect("0\n", {"times.txt", "holds 1 time stamps", "expected 2", "k.txt"});
  expect("0\n0\n", {"times.txt line 2", "repeats"});
  expect("0\nsoon\n", {"times.txt line 2, column 1 (time [s])", "'soon'"});
  ReadOptions options;
  options.times = write("times.txt", "1\n2\n");
  const auto tum = write("a.tum", kTum);
  expect_input_error([&] { read_pair(tum, tum, options); }, {"times.txt", "KITTI", "a.tum"});
}

TEST_F(TrajectoryFiles, PairsHaveStampsOfOneKind) {
  const auto tum = write("a.tum", kTum);
  const auto kitti = write("k.txt", kKitti);
  const auto shorter = write("s.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n");
  EXPECT_EQ(read_pair(kitti, kitti).estimate.stamps, Stamps::pose_number);
  expect_input_error([&] { read_pair(kitti, tum); }, {"k.txt: has no time stamps", "a.tum has"});
  expect_input_error([&] { read_pair(tum, kitti); }, {"k.txt: has no time stamps", "a.tum has"});
  expect_input_error([&] { read_pair(shorter, kitti); },
                     {"s.txt: holds 1 poses", "k.txt 2", "as many of both"});
}

TEST_F(TrajectoryFiles, PosesWithoutStampsAreMatchedByNumber) {
  const auto kitti = write("k.txt", std::string(kKitti) + "1 0 0 5 0 1 0 2 0 0 1 7\n");
  const TrajectoryPair pair = read_pair(kitti, kitti);
  EvaluationOptions options;
  options.stamps = pair.estimate.stamps;
  const Evaluation result = evaluate(pair.estimate.poses, pair.truth.poses, options);
  EXPECT_EQ(result.matched, 3u);
  EXPECT_FALSE(result.longest_gap_s);
  EXPECT_EQ(result.protocol,
            "SE3-aligned, 3 of 3 poses matched by number, completion 100.0 % (3 true poses), "
            "6.00 m of path");
}

TEST_F(TrajectoryFiles, FoldersHoldOne) {
  const auto folder = [&](const char* name) {
    std::filesystem::create_directories(folder_ / name / "mav0/state_groundtruth_estimate0");
    return folder_ / name;
  };
  const auto flight = folder("flight");
  const std::string csv = "mav0/state_groundtruth_estimate0/data.csv";
  const auto truth = write("flight/" + csv, "1,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n");
  EXPECT_EQ(find_trajectory(flight), truth);
  EXPECT_EQ(find_trajectory(flight / "mav0"), truth);
  const auto run = folder("run");
  expect_input_error([&] { find_trajectory(run); }, {"holds no trajectory", "trajectory.tum", csv});
  const auto trajectory = write("run/trajectory.tum", kTum);
  EXPECT_EQ(find_trajectory(run), trajectory);
  std::filesystem::create_directories(folder_ / "rgbd");
  const auto poses = write("rgbd/groundtruth.txt", std::string("# timestamp tx ty tz\n") + kTum);
  EXPECT_EQ(read_trajectory(folder_ / "rgbd").file, poses);
  const auto both = folder("both");
  write("both/" + csv, "");
  write("both/trajectory.tum", kTum);
  expect_input_error([&] { find_trajectory(both); }, {csv, "name the file"});
}

TEST_F(TrajectoryFiles, AForcedFormatIsNotForFolders) {
  write("trajectory.tum", kTum);
  ReadOptions options;
  options.format = TrajectoryFormat::kitti;
  EXPECT_EQ(read_trajectory(folder_.path(), options).format, TrajectoryFormat::tum);
}

}  // namespace
}  // namespace leviosim::traces
