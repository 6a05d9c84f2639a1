#include "tools/app/validation/calibration/calibration_report.h"

#include <fmt/format.h>

#include "tools/app/report/text_table.h"

namespace leviosim::tools {
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

}  // namespace leviosim::tools
