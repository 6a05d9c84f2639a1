#include "traces/trajectories/trajectory.h"

#include <gtest/gtest.h>

#include "tests/support/scratch.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using testing::expect_input_error;
using testing::TempFolder;
using tests::write_text;

Trajectory random_trajectory(std::size_t count) {
  Rng rng(5);
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector4d q(rng.normal(), rng.normal(), rng.normal(), rng.normal());
    StampedPose pose;
    pose.t_ns = 1403636584763555584 + static_cast<std::int64_t>(i) * 50'000'001;
    pose.T_world_body =
        Eigen::Translation3d(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)) *
        Eigen::Quaterniond(q.normalized());
    trajectory.push_back(pose);
  }
  return trajectory;
}

TEST(Tum, FormatIsExact) {
  StampedPose pose;
  pose.t_ns = 1403636584013555584;
  pose.T_world_body = Eigen::Translation3d(1.5, -2e-12, -3) *
                      Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5);  // w < 0: the sign is flipped
  EXPECT_EQ(format_tum({pose}),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1403636584.013555584 1.500000000 0.000000000 -3.000000000 "
            "-0.500000000 0.500000000 -0.500000000 0.500000000\n");
}

TEST(Tum, HalfTurnsHaveOneSpelling) {
  StampedPose a;
  a.T_world_body.linear() = Eigen::Quaterniond(0, 0, 0.6, -0.8).toRotationMatrix();
  StampedPose b;
  b.T_world_body.linear() = Eigen::Quaterniond(0, 0, -0.6, 0.8).toRotationMatrix();
  EXPECT_EQ(format_tum({a}), format_tum({b}));
}

TEST(Tum, RoundTrip) {
  const TempFolder folder;
  const Trajectory written = random_trajectory(200);
  write_text(folder / "t.tum", format_tum(written));
  const Trajectory read = read_tum(folder / "t.tum");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].t_ns, written[i].t_ns);
    EXPECT_LT((read[i].T_world_body.matrix() - written[i].T_world_body.matrix()).norm(), 1e-8);
  }
}

TEST(Tum, ReadsOtherSpellingsOfTime) {
  const TempFolder folder;
  outputs::write_file_atomically(folder / "t.tum",
                                 "5 0 0 0 0 0 0 1\n6.25 0 0 0 0 0 0 1\n7.1234567899 0 0 0 0 0 0 1\n"
                                 "1.5e1 0 0 0 0 0 0 1\n");
  const Trajectory read = read_tum(folder / "t.tum");
  ASSERT_EQ(read.size(), 4u);
  EXPECT_EQ(read[0].t_ns, 5'000'000'000);
  EXPECT_EQ(read[1].t_ns, 6'250'000'000);
  EXPECT_EQ(read[2].t_ns, 7'123'456'789);
  EXPECT_EQ(read[3].t_ns, 15'000'000'000);
}

TEST(Tum, BrokenFiles) {
  const TempFolder folder;
  const auto file = folder / "t.tum";
  const auto expect = [&](const std::string& text, std::initializer_list<std::string> parts) {
    outputs::write_file_atomically(file, text);
    expect_input_error([&] { read_tum(file); }, parts);
  };
  expect("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n", {"t.tum line 2", "7 columns instead of 8"});
  expect("1 0 0 nan 0 0 0 1\n", {"t.tum line 1, column 4 (tz)", "'nan'"});
  expect("1 0 0 0 0 0 0 2\n", {"t.tum line 1", "norm 2"});
  expect("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", {"t.tum line 2", "1000000000", "2000000000"});
  expect("-2 0 0 0 0 0 0 1\n", {"t.tum line 1, column 1 (timestamp)"});
  expect("# nothing\n", {"t.tum", "no pose"});
}

TEST(EurocTrajectory, ReadsThePoses) {
  const testing::AslFolder folder;
  const Trajectory read =
      read_euroc_trajectory(folder.mav0("state_groundtruth_estimate0/data.csv"));
  ASSERT_EQ(read.size(), 71u);
  EXPECT_TRUE(read[20].T_world_body.translation().isApprox(Eigen::Vector3d(1.0, 1, 2)));
}

}  // namespace
}  // namespace leviosim::traces
