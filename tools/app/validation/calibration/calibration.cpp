#include "tools/app/validation/calibration/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/nearest.h"
#include "sim/base/text.h"
#include "tools/app/report/text_table.h"
#include "tools/app/validation/calibration/least_squares.h"
#include "tools/app/validation/references.h"

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

namespace {

std::string kilo(double cycles) { return fmt::format("{:.0f}", cycles / 1e3); }

std::string percent(double simulated, double reference) {
  return fmt::format("{:+.1f} %", percent_error(simulated, reference));
}

std::string_view mechanism_of(const std::string& path) {
  for (const FittableConstant& constant : kFittableConstants)
    if (constant.path == path) return constant.mechanism;
  return "";
}

/// A fit that stands at a bound asks for more than the range allows.
const char* bound_text(const Bounded& constant, double value) {
  if (value <= constant.low) return "at the lower bound";
  if (value >= constant.high) return "at the upper bound";
  return "";
}

}  // namespace

std::string constants_table(const Calibration& calibration) {
  TextTable table({{"constant", kLeft},
                   {"before"},
                   {"fitted"},
                   {"range", kLeft},
                   {"", kLeft},
                   {"what it stands for", kLeft}});
  for (std::size_t i = 0; i < calibration.constants.size(); ++i) {
    const Bounded& constant = calibration.constants[i];
    const double fitted = calibration.fitted[i];
    table.add({constant.path, fmt::format("{:g} {}", constant.value, constant.unit),
               fmt::format("{:.4f}", fitted),
               fmt::format("{:g} … {:g}", constant.low, constant.high),
               bound_text(constant, fitted), std::string(mechanism_of(constant.path))});
  }
  return "constants, fitted to the single-core values by least squares of log ratios\n" +
         table.str();
}

std::string residual_table(const Calibration& calibration) {
  TextTable table(
      {{"stage, 1 core", kLeft}, {"paper, kcycles"}, {"before"}, {"error"}, {"fitted"}, {"error"}});
  for (const Residual& r : calibration.residuals)
    table.add({r.stage, kilo(r.reference), kilo(r.before), percent(r.before, r.reference),
               kilo(r.after), percent(r.after, r.reference)});
  return "residuals\n" + table.str() +
         fmt::format("mean absolute error: {:.1f} % before, {:.1f} % fitted\n",
                     mean_error_before(calibration), mean_error_after(calibration));
}

std::string left_out_table(const Calibration& calibration) {
  std::vector<TextTable::Column> columns{
      {"stage, left out", kLeft}, {"paper, kcycles"}, {"predicted"}, {"error"}};
  for (const Bounded& constant : calibration.constants) columns.push_back({constant.path});
  TextTable table(std::move(columns));
  for (const LeftOut& l : calibration.left_out) {
    std::vector<std::string> cells{l.stage, kilo(l.reference), kilo(l.predicted),
                                   percent(l.predicted, l.reference)};
    for (const double constant : l.constants) cells.push_back(fmt::format("{:.4f}", constant));
    table.add(std::move(cells));
  }
  return "each stage as the constants fitted to the others predict it\n" + table.str() +
         fmt::format("mean absolute error: {:.1f} %\n", mean_error_left_out(calibration));
}

std::vector<std::string> calibration_report(const Calibration& calibration) {
  return {constants_table(calibration) + '\n', residual_table(calibration) + '\n',
          left_out_table(calibration)};
}

std::string calibration_conclusion(const Calibration& calibration) {
  std::string text = "in short: ";
  for (std::size_t i = 0; i < calibration.constants.size(); ++i)
    text += fmt::format("{} {:.4f} instead of {:g}, ", calibration.constants[i].path,
                        calibration.fitted[i], calibration.constants[i].value);
  return text + fmt::format("mean absolute error {:.1f} % instead of {:.1f} %, {:.1f} % of stages "
                            "left out",
                            mean_error_after(calibration), mean_error_before(calibration),
                            mean_error_left_out(calibration));
}

Json calibration_json(const Calibration& calibration) {
  Json document{{"format", "leviosim calibration"}, {"version", 1}};
  Json& constants = document["constants"] = Json::array();
  for (std::size_t i = 0; i < calibration.constants.size(); ++i) {
    const Bounded& c = calibration.constants[i];
    constants.push_back({{"path", c.path},
                         {"unit", c.unit},
                         {"before", c.value},
                         {"fitted", calibration.fitted[i]},
                         {"low", c.low},
                         {"high", c.high}});
  }
  Json& residuals = document["residuals"] = Json::array();
  for (const Residual& r : calibration.residuals)
    residuals.push_back({{"stage", r.stage},
                         {"paper_cycles", r.reference},
                         {"cycles_before", r.before},
                         {"cycles_fitted", r.after}});
  Json& left_out = document["left_out"] = Json::array();
  for (const LeftOut& l : calibration.left_out)
    left_out.push_back({{"stage", l.stage},
                        {"paper_cycles", l.reference},
                        {"cycles_predicted", l.predicted},
                        {"constants", l.constants}});
  return document;
}

namespace {

double paper_cycles(const std::vector<Reference>& references, std::string_view key) {
  for (const Reference& reference : references)
    if (reference.name == fmt::format("compute.{}.single", key)) return reference.value * 1e3;
  throw InputError(fmt::format("paper.csv: compute.{}.single is missing", key));
}

/// Cycles of the operations alone, with their code at hand.
double cost_of(const sim::WorkSum& work, const sim::ChipConfig& chip) {
  return work.cost(chip.cluster.core).total();
}

}  // namespace

double StageModel::cycles(const sim::ChipConfig& chip) const {
  return (cost_of(work, chip) + fixed) / static_cast<double>(frames);
}

std::vector<StageModel> stage_models(const FrameLog& log, const sim::ChipConfig& chip) {
  const std::vector<Reference> references = paper_references();
  std::vector<StageModel> models;
  for (const PaperStage& stage : kPaperStages) {
    const StageSum sum = sum_over(log.frames(), stage);
    if (sum.frames == 0)
      throw InputError(
          fmt::format("no frame of the run came to {}; choose more frames or other "
                      "data",
                      stage.title));
    StageModel model;
    model.key = stage.key;
    model.title = stage.title;
    model.frames = sum.frames;
    model.work = sum.work;
    model.fixed = static_cast<double>(sum.single.count()) - cost_of(sum.work, chip);
    model.reference = paper_cycles(references, stage.key);
    models.push_back(std::move(model));
  }
  return models;
}

namespace {

void check_fittable(const std::string& option, const std::string& path) {
  std::vector<std::string> known;
  for (const FittableConstant& constant : kFittableConstants) known.emplace_back(constant.path);
  if (std::find(known.begin(), known.end(), path) != known.end()) return;
  throw InputError(
      fmt::format("{} '{}': is no constant that may be fitted{}; expected up to {} of {}", option,
                  path, base::did_you_mean(path, known), kMostConstants, fmt::join(known, ", ")));
}

}  // namespace

std::vector<std::string> parse_constants(const std::string& option, const std::string& text) {
  std::vector<std::string> paths = base::split(text, ',');
  for (const std::string& path : paths) check_fittable(option, path);
  if (paths.size() > kMostConstants)
    throw InputError(fmt::format("{} '{}': {} constants; expected at most {}", option, text,
                                 paths.size(), kMostConstants));
  for (const std::string& path : paths)
    if (std::count(paths.begin(), paths.end(), path) > 1)
      throw InputError(fmt::format("{} '{}': {} is there twice", option, text, path));
  return paths;
}

std::vector<Bounded> bounds_of(const platform::Variants& platform,
                               const std::vector<std::string>& paths) {
  std::vector<Bounded> constants;
  for (const std::string& path : paths) {
    const platform::Parameter* parameter = platform.find(path);
    if (parameter == nullptr)
      throw InputError(
          fmt::format("platform {}: does not give {}", platform.platform().name, path));
    if (!parameter->range)
      throw InputError(fmt::format("platform {}: {} has no range to be fitted within (source: {})",
                                   platform.platform().name, path, parameter->source));
    const auto value = platform::parse_number(parameter->value);
    check(value.has_value(), "a resolved parameter is no number");
    constants.push_back(
        {path, parameter->unit, *value, parameter->range->low, parameter->range->high});
  }
  return constants;
}

}  // namespace leviosim::tools
