#include "tools/app/validation/calibration/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/text.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The unknowns run from 0 to 1 across the box.
constexpr int kMaxSteps = 200;
constexpr double kDifference = 1e-6;  ///< of the derivatives
constexpr double kSettled = 1e-10;    ///< largest move of an unknown at the end
constexpr double kMostDamping = 1e12;

class Problem {
 public:
  Problem(const Residuals& residuals, const Box& box) : residuals_(residuals), box_(box) {}

  Eigen::Index size() const { return static_cast<Eigen::Index>(box_.low.size()); }

  std::vector<double> in_units(const VectorXd& x) const {
    std::vector<double> values(box_.low.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::clamp(box_.low[i] + x[static_cast<Eigen::Index>(i)] * width(i), box_.low[i],
                             box_.high[i]);
    return values;
  }

  VectorXd from_units(const std::vector<double>& values) const {
    VectorXd x(size());
    for (std::size_t i = 0; i < values.size(); ++i)
      x[static_cast<Eigen::Index>(i)] = width(i) > 0 ? (values[i] - box_.low[i]) / width(i) : 0;
    return x.cwiseMax(0.0).cwiseMin(1.0);
  }

  VectorXd residuals(const VectorXd& x) const {
    throw_if_interrupted();
    const std::vector<double> r = residuals_(in_units(x));
    return Eigen::Map<const VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
  }

  MatrixXd jacobian(const VectorXd& x) const {
    MatrixXd j(residuals(x).size(), size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      VectorXd above = x;
      VectorXd below = x;
      above[i] = std::min(x[i] + kDifference, 1.0);
      below[i] = std::max(x[i] - kDifference, 0.0);
      j.col(i) = (residuals(above) - residuals(below)) / (above[i] - below[i]);
    }
    return j;
  }

 private:
  double width(std::size_t i) const { return box_.high[i] - box_.low[i]; }

  const Residuals& residuals_;
  const Box& box_;
};

/// The damped step, with the unknowns held that stand at a bound and are pushed outwards.
VectorXd step(const VectorXd& x, const MatrixXd& j, const VectorXd& r, double damping) {
  const VectorXd gradient = j.transpose() * r;
  MatrixXd normal = j.transpose() * j;
  normal.diagonal() *= 1 + damping;
  normal.diagonal().array() += 1e-14;  // an unknown without effect stays where it is
  VectorXd right = -gradient;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool held = (x[i] <= 0 && gradient[i] >= 0) || (x[i] >= 1 && gradient[i] <= 0);
    if (!held) continue;
    normal.row(i).setZero();
    normal.col(i).setZero();
    normal(i, i) = 1;
    right[i] = 0;
  }
  return normal.ldlt().solve(right);
}

Fit descend(const Problem& problem, VectorXd x) {
  VectorXd r = problem.residuals(x);
  double damping = 1e-3;
  for (int k = 0; k < kMaxSteps && damping < kMostDamping; ++k) {
    const VectorXd delta = step(x, problem.jacobian(x), r, damping);
    const VectorXd next = (x + delta).cwiseMax(0.0).cwiseMin(1.0);
    const VectorXd r_next = problem.residuals(next);
    if (r_next.squaredNorm() < r.squaredNorm()) {
      const double moved = (next - x).cwiseAbs().maxCoeff();
      x = next;
      r = r_next;
      damping = std::max(damping / 10, 1e-12);
      if (moved < kSettled) break;
    } else {
      damping *= 10;
    }
  }
  return {problem.in_units(x), r.squaredNorm()};
}

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

/// Of all of them, the absolute error of a part, in per cent of the reference.
template <class Rows, class Part>
double mean_error(const Rows& rows, Part part) {
  double sum = 0;
  for (const auto& row : rows) sum += std::abs(percent_error(row.*part, row.reference));
  return rows.empty() ? 0 : sum / static_cast<double>(rows.size());
}

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

double paper_cycles(const std::vector<Reference>& references, std::string_view key) {
  for (const Reference& reference : references)
    if (reference.name == fmt::format("compute.{}.single", key)) return reference.value * 1e3;
  throw InputError(fmt::format("paper.csv: compute.{}.single is missing", key));
}

/// Cycles of the operations alone, with their code at hand.
double cost_of(const sim::WorkSum& work, const sim::ChipConfig& chip) {
  return work.cost(chip.cluster.core).total();
}

void check_fittable(const std::string& option, const std::string& path) {
  std::vector<std::string> known;
  for (const FittableConstant& constant : kFittableConstants) known.emplace_back(constant.path);
  if (std::find(known.begin(), known.end(), path) != known.end()) return;
  throw InputError(
      fmt::format("{} '{}': is no constant that may be fitted{}; expected up to {} of {}", option,
                  path, base::did_you_mean(path, known), kMostConstants, fmt::join(known, ", ")));
}

}  // namespace

Fit least_squares(const Residuals& residuals, const Box& box, const std::vector<double>& start) {
  check_equal(box.low.size(), start.size(), "lower bounds");
  check_equal(box.high.size(), start.size(), "upper bounds");
  const Problem problem(residuals, box);
  Fit best = descend(problem, problem.from_units(start));
  for (unsigned corner = 0; corner < 1u << start.size(); ++corner) {
    VectorXd x(problem.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = corner >> i & 1u ? 0.75 : 0.25;
    Fit fit = descend(problem, x);
    // Of points that are as good, the one found first is kept.
    if (fit.cost < best.cost - 1e-12 * (1 + best.cost)) best = std::move(fit);
  }
  return best;
}

double percent_error(double simulated, double reference) {
  return 100 * (simulated / reference - 1);
}

double mean_error_before(const Calibration& calibration) {
  return mean_error(calibration.residuals, &Residual::before);
}

double mean_error_after(const Calibration& calibration) {
  return mean_error(calibration.residuals, &Residual::after);
}

double mean_error_left_out(const Calibration& calibration) {
  return mean_error(calibration.left_out, &LeftOut::predicted);
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

std::string constants_table(const Calibration& calibration) {
  Table table({{"constant", kLeft},
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
         terminal_text(table);
}

std::string residual_table(const Calibration& calibration) {
  using R = const Residual&;
  const Columns<Residual> table{{{"stage, 1 core", kLeft}, [](R r) { return r.stage; }},
                                {{"paper, kcycles"}, [](R r) { return kilo(r.reference); }},
                                {{"before"}, [](R r) { return kilo(r.before); }},
                                {{"error"}, [](R r) { return percent(r.before, r.reference); }},
                                {{"fitted"}, [](R r) { return kilo(r.after); }},
                                {{"error"}, [](R r) { return percent(r.after, r.reference); }}};
  return "residuals\n" + terminal_text(table_of(table, calibration.residuals)) +
         fmt::format("mean absolute error: {:.1f} % before, {:.1f} % fitted\n",
                     mean_error_before(calibration), mean_error_after(calibration));
}

std::string left_out_table(const Calibration& calibration) {
  using L = const LeftOut&;
  Columns<LeftOut> table{{{"stage, left out", kLeft}, [](L l) { return l.stage; }},
                         {{"paper, kcycles"}, [](L l) { return kilo(l.reference); }},
                         {{"predicted"}, [](L l) { return kilo(l.predicted); }},
                         {{"error"}, [](L l) { return percent(l.predicted, l.reference); }}};
  for (std::size_t i = 0; i < calibration.constants.size(); ++i)
    table.push_back({{.title = calibration.constants[i].path, .shown = 4},
                     [i](L l) { return l.constants[i]; }});
  return "each stage as the constants fitted to the others predict it\n" +
         terminal_text(table_of(table, calibration.left_out)) +
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
  return text + fmt::format(
                    "mean absolute error {:.1f} % instead of {:.1f} %, {:.1f} % of stages "
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
