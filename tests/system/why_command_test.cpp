// leviosim why: the answer to "why was this frame late?" as users meet it.
#include <algorithm>

#include "tests/support/program_suite.h"
#include "tests/support/run_program.h"
#include "tools/app/record/statistic_list.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using testing::expect_refused;
using testing::ProgramResult;

class WhyCommand : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("why");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 1.2, .texel_m = 0.02});
    expect_done({"run", "--data", path("flight"), "--out", path("run"), "--record", "--quiet"});
  }

  static ProgramResult why(std::vector<std::string> words) {
    words.insert(words.begin(), {"why", path("run"), "--quiet"});
    return program(words);
  }
  static Json answer(std::vector<std::string> words) {
    words.emplace_back("--json");
    const ProgramResult result = why(std::move(words));
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out);
  }
  static double number(const Json& found, const char* key) { return found.at(key).get<double>(); }
};

TEST_F(WhyCommand, NamesTheSlowestFrameAndFitsAScreen) {
  const Json found = answer({});
  const int slowest = found.at("frame").at("frame").get<int>();
  for (int frame = 0; frame < 24; ++frame)
    EXPECT_LE(number(answer({std::to_string(frame)}).at("frame"), "latency_ms"),
              number(found.at("frame"), "latency_ms"))
        << frame;
  const ProgramResult result = why({});
  EXPECT_NE(result.out.find("in short: frame " + std::to_string(slowest)), std::string::npos)
      << result.out;
  EXPECT_LE(std::count(result.out.begin(), result.out.end(), '\n'), 24) << result.out;
}

/// The stages of a frame are its own time but for the call of the cluster, in both frames; and what
/// a frame waited for the one before is no time of its own.
TEST_F(WhyCommand, StagesAddUpToTheFramesOwnTime) {
  for (const char* clock : {"370MHz", "150MHz"}) {
    const Json found = answer({"-p", std::string("cluster.clock=") + clock});
    double median = 0, frame = 0;
    for (const Json& stage : found.at("stages")) {
      median += number(stage, "median_ms");
      frame += number(stage, "ms");
    }
    constexpr double kCalls_ms = 0.1;
    EXPECT_NEAR(median, number(found.at("median"), "own_ms"), kCalls_ms) << clock;
    EXPECT_NEAR(frame, number(found.at("frame"), "own_ms"), kCalls_ms) << clock;
    EXPECT_NEAR(number(found.at("frame"), "waited_ms") + number(found.at("frame"), "own_ms"),
                number(found.at("frame"), "latency_ms"), 1e-9);
  }
}

/// At a third of the clock frames are late, and wait for those before them.
TEST_F(WhyCommand, TellsWaitingFromWork) {
  const Json found = answer({"-p", "cluster.clock=120MHz", "-p", "controller.clock=120MHz"});
  const std::string text = found.at("answer");
  EXPECT_GT(number(found.at("frame"), "waited_ms"), 0);
  EXPECT_NE(text.find("ms late"), std::string::npos) << text;
  EXPECT_NE(text.find("waiting for the frame before"), std::string::npos) << text;
}

TEST_F(WhyCommand, RefusesFramesAndRunsThatThereAreNot) {
  expect_refused(why({"24"}), {"FRAME '24'", "0 to 23"});
  expect_refused(why({"first"}), {"FRAME 'first'", "0 to 23"});
  expect_refused(program({"why", path("flight")}), {"flight", "run with --record"});
  expect_refused(program({"why"}), {"RUN", "run with --record"});
}

}  // namespace
}  // namespace leviosim::tools
