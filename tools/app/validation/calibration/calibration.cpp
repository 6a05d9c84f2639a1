#include "tools/app/validation/calibration/calibration.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/base/check.h"
#include "tools/app/validation/calibration/least_squares.h"

namespace leviosim::tools {
namespace {

std::vector<platform::Change> changes(const std::vector<Bounded>& constants,
                                      const std::vector<double>& values) {
  std::vector<platform::Change> list;
  for (std::size_t i = 0; i < constants.size(); ++i) list.push_back({constants[i].path, values[i]});
  return list;
}

/// Digits beyond which a constant means nothing: a millionth of its range.
double rounded(const Bounded& constant, double value) {
  const double width = constant.high - constant.low;
  if (!(width > 0)) return value;
  const double step = std::pow(10.0, std::floor(std::log10(width)) - 5);
  const double text = std::round(value / step) * step;
  // Through text, so that the file holds 1.2345 and not the next double.
  const auto parsed = platform::parse_number(fmt::format("{:.9g}", text));
  check(parsed.has_value(), "a number that was just written");
  return std::min(std::max(*parsed, constant.low), constant.high);
}

std::vector<double> fit(const platform::Variants& platform,
                        const std::vector<const StageModel*>& stages,
                        const std::vector<Bounded>& constants) {
  Box box;
  std::vector<double> start;
  for (const Bounded& constant : constants) {
    box.low.push_back(constant.low);
    box.high.push_back(constant.high);
    start.push_back(constant.value);
  }
  const Residuals residuals = [&](const std::vector<double>& values) {
    const sim::ChipConfig chip = platform.config(changes(constants, values));
    std::vector<double> logarithms;
    for (const StageModel* stage : stages)
      logarithms.push_back(std::log(stage->cycles(chip) / stage->reference));
    return logarithms;
  };
  std::vector<double> found = least_squares(residuals, box, start).at;
  for (std::size_t i = 0; i < found.size(); ++i) found[i] = rounded(constants[i], found[i]);
  return found;
}

double mean_of(const std::vector<double>& errors) {
  double sum = 0;
  for (const double error : errors) sum += std::abs(error);
  return errors.empty() ? 0 : sum / static_cast<double>(errors.size());
}

}  // namespace

double percent_error(double simulated, double reference) {
  return 100 * (simulated / reference - 1);
}

double mean_error_before(const Calibration& calibration) {
  std::vector<double> errors;
  for (const Residual& r : calibration.residuals)
    errors.push_back(percent_error(r.before, r.reference));
  return mean_of(errors);
}

double mean_error_after(const Calibration& calibration) {
  std::vector<double> errors;
  for (const Residual& r : calibration.residuals)
    errors.push_back(percent_error(r.after, r.reference));
  return mean_of(errors);
}

double mean_error_left_out(const Calibration& calibration) {
  std::vector<double> errors;
  for (const LeftOut& l : calibration.left_out)
    errors.push_back(percent_error(l.predicted, l.reference));
  return mean_of(errors);
}

Calibration calibrate(const platform::Variants& platform, const std::vector<StageModel>& stages,
                      const std::vector<std::string>& constants) {
  Calibration result;
  result.constants = bounds_of(platform, constants);
  std::vector<const StageModel*> all;
  for (const StageModel& stage : stages) all.push_back(&stage);
  result.fitted = fit(platform, all, result.constants);
  const sim::ChipConfig before = platform.config({});
  const sim::ChipConfig after = platform.config(changes(result.constants, result.fitted));
  for (const StageModel& stage : stages) {
    result.residuals.push_back(
        {stage.title, stage.reference, stage.cycles(before), stage.cycles(after)});
    std::vector<const StageModel*> others;
    for (const StageModel& other : stages)
      if (&other != &stage) others.push_back(&other);
    LeftOut left_out{stage.title, stage.reference, 0, fit(platform, others, result.constants)};
    left_out.predicted =
        stage.cycles(platform.config(changes(result.constants, left_out.constants)));
    result.left_out.push_back(std::move(left_out));
  }
  return result;
}

platform::ResolvedPlatform calibrated_platform(const platform::Variants& platform,
                                               const Calibration& calibration) {
  const std::string how =
      fmt::format("least squares over {} single-core values", calibration.residuals.size());
  return platform.calibrated(
      changes(calibration.constants, calibration.fitted), how,
      "leviosim calibrate: fitted to the single-core compute table of the LEVIO paper");
}

}  // namespace leviosim::tools
