// Fits of constants that are known, and what must not be fitted.
#include "tools/app/validation/calibration/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "platform_models/loader/loader.h"
#include "sim/work/op.h"
#include "tests/traces/test_folder.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;
using work::Op;

platform::Variants gap9(const std::vector<std::string>& overrides = {}) {
  return platform::Variants(platform::resolve_platform("gap9", overrides));
}

StageModel stage(const std::string& name, std::uint64_t alu, std::uint64_t loads,
                 std::uint64_t iterations, double fixed) {
  StageModel model;
  model.key = model.title = name;
  model.frames = 2;
  work::Counts counts;
  counts[Op::IntAlu] = alu;
  counts[Op::LoadStream] = loads;
  counts[Op::LoopIteration] = iterations;
  model.work.add(counts, work::CompiledFor::Rv32imfc);
  model.fixed = fixed;
  return model;
}

/// Six stages of different mixes, whose references are what `truth` gives.
std::vector<StageModel> stages_of(const sim::ChipConfig& truth) {
  std::vector<StageModel> stages{
      stage("a", 10'000, 1'000, 100, 50),         stage("b", 5'000, 6'000, 800, 0),
      stage("c", 100'000, 20'000, 40'000, 2'000), stage("d", 1'000, 3'000, 10, 10),
      stage("e", 2'000, 100, 1'500, 0),           stage("f", 700, 700, 700, 100)};
  for (StageModel& s : stages) s.reference = s.cycles(truth);
  return stages;
}

const std::vector<std::string> kThree = parse_constants("--constants", kDefaultConstants);

TEST(LeastSquares, FindsALineAndStaysInTheBox) {
  const auto residuals = [](const std::vector<double>& x) {
    return std::vector<double>{x[0] - 2, x[1] - 3, 0.5 * (x[0] + x[1] - 5)};
  };
  const Fit inside = least_squares(residuals, {{0, 0}, {10, 10}}, {9, 1});
  EXPECT_NEAR(inside.at[0], 2, 1e-6);
  EXPECT_NEAR(inside.at[1], 3, 1e-6);
  EXPECT_NEAR(inside.cost, 0, 1e-10);
  // With x[1] held at 1, the best x[0] minimises (x-2)² + (x-4)²/4.
  const Fit bounded = least_squares(residuals, {{0, 0}, {10, 1}}, {0, 0});
  EXPECT_DOUBLE_EQ(bounded.at[1], 1);
  EXPECT_NEAR(bounded.at[0], 2.4, 1e-6);
}

TEST(LeastSquares, LeavesTheWorseOfTwoValleys) {
  const auto residuals = [](const std::vector<double>& x) {
    return std::vector<double>{(x[0] - 1) * (x[0] - 9), 0.1 * (x[0] - 9)};
  };
  EXPECT_NEAR(least_squares(residuals, {{0}, {10}}, {0}).at[0], 9, 1e-4);
}

TEST(LeastSquares, AnUnknownWithoutEffectAndAnEmptyRangeDoNotHurt) {
  const auto residuals = [](const std::vector<double>& x) { return std::vector<double>{x[0] - 2}; };
  const Fit fit = least_squares(residuals, {{0, 0, 5}, {10, 1, 5}}, {1, 0.5, 5});
  EXPECT_NEAR(fit.at[0], 2, 1e-6);
  EXPECT_EQ(fit.at[2], 5);
}

TEST(Calibration, RecoversKnownConstants) {
  const platform::Variants platform = gap9();
  const sim::ChipConfig truth = platform.config({{"isa.instruction_overhead", 1.3},
                                                 {"isa.load_use_fraction", 0.4},
                                                 {"isa.ops.loop_iteration.issue", 0.75}});
  const Calibration c = calibrate(platform, stages_of(truth), kThree);
  ASSERT_EQ(c.fitted.size(), 3u);
  EXPECT_NEAR(c.fitted[0], 1.3, 1e-4);
  EXPECT_NEAR(c.fitted[1], 0.4, 1e-4);
  EXPECT_NEAR(c.fitted[2], 0.75, 1e-4);
  EXPECT_GT(mean_error_before(c), 10);
  EXPECT_LT(mean_error_after(c), 0.01);
  EXPECT_LT(mean_error_left_out(c), 0.01);
}

TEST(Calibration, GivesTheSameNumbersAgain) {
  const platform::Variants platform = gap9();
  std::vector<StageModel> stages = stages_of(platform.config({{"isa.load_use_fraction", 0.5}}));
  stages[2].reference *= 1.2;
  EXPECT_EQ(calibrate(platform, stages, kThree).fitted, calibrate(platform, stages, kThree).fitted);
}

TEST(Calibration, StopsAtTheEndOfARange) {
  const platform::Variants platform = gap9();
  std::vector<StageModel> stages = stages_of(platform.config({}));
  for (StageModel& s : stages) s.reference *= 3;
  const Calibration c = calibrate(platform, stages, {"isa.instruction_overhead"});
  EXPECT_EQ(c.fitted, std::vector<double>{1.4});
  EXPECT_NE(constants_table(c).find("at the upper bound"), std::string::npos);
}

/// Stages of nothing but instructions: cycles are proportional to the overhead, so the best one is
/// the geometric mean of what the stages ask for, with or without one of them.
TEST(Calibration, LeavesAStageOutOfItsOwnPrediction) {
  const platform::Variants platform = gap9();
  const std::vector<double> asked{1.1, 1.2, 1.5};
  std::vector<StageModel> stages;
  for (const double overhead : asked) {
    stages.push_back(stage("s", 10'000, 0, 0, 0));
    stages.back().reference = 5'000 * overhead;
  }
  const Calibration c = calibrate(platform, stages, {"isa.instruction_overhead"});
  EXPECT_NEAR(c.fitted[0], std::cbrt(1.1 * 1.2 * 1.5), 1e-5);
  for (std::size_t i = 0; i < 3; ++i) {
    double others = 1;
    for (std::size_t k = 0; k < 3; ++k) others *= k == i ? 1 : asked[k];
    EXPECT_NEAR(c.left_out[i].constants[0], std::sqrt(others), 1e-5);
    EXPECT_NEAR(c.left_out[i].predicted, 5'000 * std::sqrt(others), 0.1);
  }
}

TEST(Calibration, WritesAPlatformThatGivesTheFittedCycles) {
  const platform::Variants platform = gap9();
  std::vector<StageModel> stages =
      stages_of(platform.config({{"isa.instruction_overhead", 1.234567}}));
  stages[0].reference *= 0.9;
  const Calibration c = calibrate(platform, stages, kThree);
  const platform::ResolvedPlatform again = platform::resolve_platform_text(
      "c.yaml", platform::to_yaml(calibrated_platform(platform, c)));
  for (std::size_t i = 0; i < stages.size(); ++i)
    EXPECT_DOUBLE_EQ(stages[i].cycles(again.config), c.residuals[i].after);
  for (const platform::Parameter& p : again.parameters)
    EXPECT_EQ(p.confidence == "calibrated", std::count(kThree.begin(), kThree.end(), p.path) > 0 ||
                                                p.path.rfind("isa.ops.loop_iteration.", 0) == 0)
        << p.path;
}

TEST(Calibration, ReportHasARowForEachConstantAndStage) {
  const platform::Variants platform = gap9();
  const Calibration c = calibrate(platform, stages_of(platform.config({})), kThree);
  std::string text;
  for (const std::string& part : calibration_report(c)) text += part;
  for (const std::string& path : kThree) EXPECT_NE(text.find(path), std::string::npos);
  EXPECT_NE(text.find("mean absolute error: 0.0 % before, 0.0 % fitted"), std::string::npos);
}

TEST(Constants, OnlyGlobalOnesAndNoMoreThanThree) {
  const auto refuse = [](const std::string& text, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_constants("--constants", text); }, parts);
  };
  refuse("isa.instruction_overhed", {"--constants", "did you mean 'isa.instruction_overhead'"});
  refuse("cluster.fpu.units", {"cluster.fpu.units", "may be fitted"});
  refuse("isa.ops.f64_add.issue", {"may be fitted"});  // it belongs to two stages
  refuse("", {"''"});
  refuse("isa.instruction_overhead,isa.instruction_overhead", {"twice"});
  refuse(std::string(kDefaultConstants) + ",isa.ops.call.issue", {"4 constants", "at most 3"});
}

TEST(Constants, NeedARange) {
  expect_input_error(
      [] { bounds_of(gap9({"isa.load_use_fraction=0.3"}), {"isa.load_use_fraction"}); },
      {"isa.load_use_fraction", "no range", "override"});
}

TEST(StageModels, ARunWithoutAStageIsRefused) {
  expect_input_error([] { stage_models(FrameLog{}, gap9().config({})); },
                     {"no frame", "feature extraction"});
}

}  // namespace
}  // namespace leviosim::tools
