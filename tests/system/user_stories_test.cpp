// What leviosim is for, as a user meets it: four questions, each answered by a command or two
// (tools/STORIES.md shows their output on real frames).
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program_suite.h"
#include "tests/tools/junit_schema.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using nlohmann::json;
using testing::ProgramResult;

/// Four seconds of flight, the first at rest, recorded once.
class UserStories : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("stories");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 4, .texel_m = 0.02});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("recorded"),
                 "--record", "--quiet"});
  }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(path(name)) << text;
  }
  static void expect_holds(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in:\n" << text;
  }
};

TEST_F(UserStories, WhatASecondDividerBringsByWhichMechanismAtWhatEnergy) {
  const ProgramResult result = program({"compare", path("recorded"), "-p", "cluster.fpu.dividers=2",
                                        "--quiet", "--report", path("divider.html")});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_holds(result.out, "work: the same operations and calls in all stages");
  expect_holds(result.out, "why a mean frame takes another time:");
  expect_holds(result.out, "waiting for the shared divider");
  expect_holds(result.out, "frame time, mean");
  expect_holds(base::read_text_file(path("divider.html")), "waiting for the shared divider");

  // The 8-point stage gains, EPnP does not, and the whole chip spends no more.
  const ProgramResult as_json =
      program({"compare", path("recorded"), "-p", "cluster.fpu.dividers=2", "--quiet", "--json"});
  ASSERT_EQ(as_json.status, 0) << as_json.err;
  const json found = json::parse(as_json.out);
  for (const json& stage : found.at("stages")) {
    const double difference = stage.at("parallel").at("difference").get<double>();
    if (stage.at("key") == "eight_point_ransac") {
      EXPECT_LT(difference, -1000);
    } else if (stage.at("key") == "frame_matching") {
      EXPECT_EQ(difference, 0);
    }
  }
  EXPECT_LT(found.at("energy_by_stage").at("difference").get<double>(), 0);
}

TEST_F(UserStories, TheLowestClockAtTwentyFramesPerSecondWithinAnError) {
  const ProgramResult result =
      program({"tune", "--data", path("flight"), "--clock", "60:370:155", "--fps", "20", "--ate",
               "0.4", "--cache", path("cache"), "--out", path("clock"), "--quiet", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const json found = json::parse(result.out);

  const double clock = found.at("lowest").at(0).at("clock_mhz").get<double>();
  EXPECT_EQ(clock, 370);
  EXPECT_EQ(found.at("chosen").get<std::string>().rfind("for seed in 1 2 3; do leviosim run", 0),
            0u);
}

TEST_F(UserStories, AJobFailsBecauseEpnpBecameSlowerAndNamesTheFunction) {
  const ProgramResult baseline = program({"budget", "record", path("recorded")});
  ASSERT_EQ(baseline.status, 0) << baseline.err;
  write("baseline.json", baseline.out);
  write("budgets.yaml",
        "budgets:\n  - owner: firmware\n    limits:\n      - stage: EPnP RANSAC\n"
        "        limit: cycles <= +3 %\n");
  const auto check = [](const std::string& issue) {
    return program({"check", path("recorded"), "-p", "isa.ops.f32_mul.issue=" + issue, "--quiet",
                    "--force", "--budget", path("budgets.yaml"), "--baseline",
                    path("baseline.json"), "--junit", path("junit.xml"), "--annotations",
                    "github"});
  };
  EXPECT_EQ(check("1").status, 0);  // as the platform has it

  const ProgramResult result = check("4");
  EXPECT_EQ(result.status, 1) << result.out << result.err;
  expect_holds(result.out, "where: EPnP RANSAC, solve EPnP");
  expect_holds(result.out, "why: issue: f32_mul +");
  expect_holds(result.out, "::error file=");
  const std::string junit = base::read_text_file(path("junit.xml"));
  EXPECT_EQ(testing::junit_fault(junit), "");
  expect_holds(junit, "failures=\"1\"");
  expect_holds(junit, "where: EPnP RANSAC, solve EPnP");
}

TEST_F(UserStories, MyTrajectoryBesideTheTruthAndAnotherEstimator) {
  expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--profile", "next", "--out",
               path("next"), "--quiet"});
  const ProgramResult result = program({"eval", path("recorded"), path("flight"), "--also",
                                        path("next"), "--align", "posyaw", "--relative", "0.5"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part : {"recorded", "next", "ATE", "PosYaw-aligned"})
    expect_holds(result.out, part);
}

}  // namespace
}  // namespace leviosim::tools
