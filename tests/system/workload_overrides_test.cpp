// Parameters of the workload on the command line.
#include "tools/app/run/workload_options.h"

#include <gtest/gtest.h>

#include "tests/support/run_program.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/run_request.h"
#include "traces/synthesis/synthetic.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::AslFolder;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

double value_of_one(const std::string& text) {
  return parse_workload_overrides({text}).at(0).value;
}

TEST(WorkloadOverrides, AreToldFromThoseOfTheChip) {
  const SplitOverrides split =
      split_overrides({"cluster.workers=4", " workload.window=6", "workloads=1"});
  EXPECT_EQ(split.chip, (std::vector<std::string>{"cluster.workers=4", "workloads=1"}));
  EXPECT_EQ(split.workload, (std::vector<std::string>{" workload.window=6"}));
}

TEST(WorkloadOverrides, AreRead) {
  EXPECT_EQ(value_of_one("workload.window=6"), 6);
  EXPECT_EQ(value_of_one("workload.window = 6 keyframes"), 6);
  EXPECT_EQ(value_of_one("workload.reprojection_noise=1.5px"), 1.5);
  EXPECT_EQ(value_of_one("workload.imu_noise.gyro=2e-3"), 2e-3);
  EXPECT_EQ(value_of_one("workload.gravity_updates=off"), 0);
  EXPECT_EQ(value_of_one("workload.gravity_updates=on"), 1);
}

TEST(WorkloadOverrides, RefuseFaults) {
  const auto refuse = [](const std::string& text, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_workload_overrides({text}); }, parts);
  };
  refuse("workload.window", {"-p workload.window", "path=value"});
  refuse("workload.widnow=6", {"'workload.widnow'", "did you mean 'workload.window'?"});
  refuse("workload.window=1", {"'1'", "a whole number of keyframes from 2 to 32"});
  refuse("workload.window=6.5", {"'6.5'", "whole number"});
  refuse("workload.window=6 px", {"'6 px'"});
  refuse("workload.window=", {"''"});
  refuse("workload.window=nan", {"'nan'"});
  refuse("workload.keyframe_parallax=0", {"from 0.001 to 1"});
  refuse("workload.gravity_updates=1", {"'1'", "off or on"});
  expect_input_error(
      [] {
        parse_workload_overrides({"workload.window=6", "workload.window=7"});
      },
      {"already given"});
}

TEST(WorkloadOverrides, RefuseContradictions) {
  const auto refuse = [](const std::string& profile, const std::vector<std::string>& overrides,
                         std::initializer_list<std::string> parts) {
    RunRequest request;
    request.profile = profile;
    request.workload = parse_workload_overrides(overrides);
    expect_input_error([&] { profile_of(request); }, parts);
  };
  refuse("next", {"workload.joint=off", "workload.subpixel_steps=16"},
         {"workload.subpixel_steps", "workload.joint=on"});
  refuse("next", {"workload.released=on"}, {"workload.released=off", "levio"});
  refuse("levio", {"workload.subpixel_steps=4"}, {"workload.subpixel_steps=1"});
  refuse("levio-no-imu", {"workload.joint=on"}, {"without IMU"});
  refuse("levio", {"workload.loop=on"}, {"workload.loop=off", "workload.guided=on"});
  refuse("next", {"workload.joint=off"}, {"workload.subpixel_steps", "workload.joint=on"});
  refuse("next-loop", {"workload.joint=off", "workload.subpixel_steps=1"},
         {"workload.loop is on", "workload.joint=on"});
  RunRequest both;
  both.profile = "next";
  both.workload = parse_workload_overrides({"workload.joint=off", "workload.subpixel_steps=1"});
  EXPECT_NO_THROW(profile_of(both));
}

TEST(WorkloadOverrides, ReachTheRunAndItsManifest) {
  const AslFolder data;
  const TempFolder folder;
  const auto run = [&](const std::string& out, std::vector<std::string> further) {
    std::vector<std::string> words{"run",    "--native", "--data", data.root().string(),
                                   "--size", "32x24",    "--out",  (folder / out).string(),
                                   "--quiet"};
    words.insert(words.end(), further.begin(), further.end());
    return run_program(folder.path(), words);
  };
  const ProgramResult set = run("set", {"-p", "workload.window=6"});
  EXPECT_EQ(set.status, 0) << set.err;
  EXPECT_NE(set.out.find(" workload.window=6\n"), std::string::npos) << set.out;
  EXPECT_EQ(run("plain", {}).status, 0);
  const auto manifest = [&](const std::string& out) {
    return Json::parse(base::read_text_file(folder / (out + "/manifest.json")));
  };
  EXPECT_EQ(manifest("set").at("workload"), Json::array({"workload.window=6"}));
  EXPECT_FALSE(manifest("plain").contains("workload"));
  expect_refused(run("bad", {"-p", "workload.windows=6"}), {"did you mean 'workload.window'?"});
  expect_refused(run("bad", {"-p", "cluster.workers=6"}), {"leave out --set cluster.workers=6"});
}

TEST(WorkloadOverrides, ABudgetOfL1IsASmallerL1) {
  const TempFolder folder;
  traces::write_synthetic_flight(folder / "flight", {.duration_s = 1, .texel_m = 0.02});
  const auto run = [&](const std::string& out, const std::string& set) {
    return run_program(folder.path(),
                       {"run", "--data", (folder / "flight").string(), "--platform", "gap9",
                        "--out", (folder / out).string(), "--quiet", "-p", set});
  };
  const auto table = [&](const std::string& file) { return base::read_text_file(folder / file); };
  for (const auto& [out, set] : {std::pair{"budget", "workload.l1=32KiB"},
                                 {"size", "cluster.l1.size=32KiB"},
                                 {"all", "workload.l1=0"}}) {
    const ProgramResult result = run(out, set);
    EXPECT_EQ(result.status, 0) << result.err;
  }
  EXPECT_EQ(table("budget/stages.csv"), table("size/stages.csv"));
  EXPECT_NE(table("budget/stages.csv"), table("all/stages.csv"));
  EXPECT_EQ(table("budget/trajectory.tum"), table("all/trajectory.tum"));
}

/// A run of a second on GAP9 with a setting.
class SmallMemory : public ::testing::Test {
 protected:
  ProgramResult run(const std::string& set) {
    return run_program(folder_.path(),
                       {"run", "--data", (folder_ / "flight").string(), "--platform", "gap9",
                        "--out", (folder_ / "out").string(), "--quiet", "--force", "-p", set});
  }
  /// Of the key that ends in "=", in KiB: what is said of a memory of 4 KiB, in which nothing
  /// works. It works, and nothing less does.
  int least_of(const std::string& key, const std::string& block) {
    const ProgramResult small = run(key + "4KiB");
    expect_refused(small, {block, "is the least in which a native run works"});
    const std::size_t at = small.err.find(key, small.err.find("missing")) + key.size();
    const int least = std::stoi(small.err.substr(at));
    EXPECT_GT(least, 4);
    expect_refused(run(key + std::to_string(least - 1) + "KiB"),
                   {"is the least in which a native run works"});
    const ProgramResult fits = run(key + std::to_string(least) + "KiB");
    EXPECT_EQ(fits.status, 0) << fits.err;
    return least;
  }

  void SetUp() override {
    traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
  }
  const TempFolder folder_;
};

TEST_F(SmallMemory, OfL1IsToldTheLeastThatWorks) {
  const int least = least_of("cluster.l1.size=", "feature extraction");
  expect_refused(run("workload.l1=4KiB"), {"workload.l1=" + std::to_string(least) +
                                           "KiB is the least in which a native run works"});
}

TEST_F(SmallMemory, OfL2IsToldTheLeastThatWorks) {
  EXPECT_GT(least_of("l2.size=", "does not fit in L2"), 64);
}

/// Also where frames come later to the chip's optimiser than natively.
TEST(WorkloadOverrides, TheLeastL1OfANativeRunIsEnoughForTheChip) {
  const TempFolder folder;
  traces::write_synthetic_flight(folder / "flight", {.duration_s = 3, .texel_m = 0.02});
  for (const char* profile : {"levio", "next"})
    for (const char* frames : {"0:20", "30:60"}) {
      const auto run = [&](int kib) {
        return run_program(folder.path(), {"run", "--data", (folder / "flight").string(),
                                           "--platform", "gap9", "--profile", profile, "--frames",
                                           frames, "--out", (folder / "out").string(), "--quiet",
                                           "--force", "-p", fmt::format("workload.l1={}KiB", kib)});
      };
      const std::string said = run(8).err;
      const std::string before = "workload.l1=";
      ASSERT_NE(said.find(before), std::string::npos) << said;
      const int least = std::stoi(said.substr(said.find(before) + before.size()));
      EXPECT_EQ(run(least).status, 0) << profile << ' ' << frames << ' ' << least;
    }
}

TEST(WorkloadCommand, ListsProfilesAndParameters) {
  const TempFolder folder;
  const ProgramResult result = run_program(folder.path(), {"workload"});
  EXPECT_EQ(result.status, 0) << result.err;
  for (const std::string& name : vio::profile_names())
    EXPECT_NE(result.out.find("  " + name + ": "), std::string::npos) << name;
  for (const vio::Parameter& p : vio::parameters())
    EXPECT_NE(result.out.find(std::string(p.name)), std::string::npos) << p.name;
  expect_refused(run_program(folder.path(), {"workload", "--profile", "levoi"}), {"levoi"});
}

}  // namespace
}  // namespace leviosim::tools
