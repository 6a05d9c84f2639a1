// A factor on all instructions that is known is found again, with the error that a fit has.
#include "tools/app/validation/calibration/calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "platform_models/loader/loader.h"
#include "sim/work/op.h"
#include "tests/traces/test_folder.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;

/// Three stages of which the factor multiplies all, half and a tenth.
std::vector<StageOnOneCore> stages_with(double factor) {
  std::vector<StageOnOneCore> stages{
      {"a", 0, 10'000, 10'000}, {"b", 0, 5'000, 2'500}, {"c", 0, 70'000, 7'000}};
  for (StageOnOneCore& stage : stages) stage.reference = stage.with(factor);
  return stages;
}

TEST(Calibration, FindsAFactorThatIsKnown) {
  for (const double factor : {0.5, 1.0, 1.3, 3.0}) {
    const FactorFit fit = fit_factor(stages_with(factor));
    EXPECT_NEAR(fit.factor, factor, 1e-9);
    EXPECT_NEAR(fit.error, 0, 1e-9);
    EXPECT_NEAR(mean_error(stages_with(factor), factor), 0, 1e-9);
  }
}

/// Stages of nothing but instructions: the best factor is the geometric mean of what they ask for,
/// with or without one of them, and its error that of a mean of logarithms.
TEST(Calibration, IsAMeanOfWhatTheStagesAskFor) {
  const std::vector<double> asked{1.1, 1.2, 1.5};
  std::vector<StageOnOneCore> stages;
  for (const double factor : asked) stages.push_back({"s", 5'000 * factor, 5'000, 5'000});
  const FactorFit fit = fit_factor(stages);
  const double mean = std::cbrt(1.1 * 1.2 * 1.5);
  EXPECT_NEAR(fit.factor, mean, 1e-9);
  double squares = 0;
  for (const double factor : asked) squares += std::pow(std::log(factor / mean), 2);
  EXPECT_NEAR(fit.error, mean * std::sqrt(squares / 2 / 3), 1e-9);
  for (std::size_t i = 0; i < 3; ++i) {
    double others = 1;
    for (std::size_t k = 0; k < 3; ++k) others *= k == i ? 1 : asked[k];
    EXPECT_NEAR(factor_without(stages, stages[i]), std::sqrt(others), 1e-9);
  }
}

TEST(Calibration, TellsTheFactorAndEachStage) {
  const std::vector<StageOnOneCore> stages = stages_with(1.25);
  EXPECT_NE(factor_conclusion(stages).find("1.250 ± 0.000"), std::string::npos);
  for (const StageOnOneCore& stage : stages)
    EXPECT_NE(factor_table(stages).find(stage.title), std::string::npos);
  EXPECT_EQ(factor_json(stages)["stages"].size(), 3u);
}

TEST(Calibration, ARunWithoutAStageIsRefused) {
  expect_input_error([] { stages_on_one_core(FrameLog{}, platform::load_platform("gap9")); },
                     {"no frame", "feature extraction"});
}

}  // namespace
}  // namespace leviosim::tools
