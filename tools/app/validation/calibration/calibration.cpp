#include "tools/app/validation/calibration/calibration.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/paper_stages.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {
namespace {

double paper_cycles(const std::vector<Reference>& references, std::string_view key) {
  for (const Reference& reference : references)
    if (reference.name == fmt::format("compute.{}.single", key)) return reference.value * 1e3;
  throw InputError(fmt::format("paper.csv: compute.{}.single is missing", key));
}

/// Cycles that the core issues instructions in, but those of library routines.
double issued(const sim::WorkSum& work, const sim::CoreConfig& core) {
  sim::CoreConfig without = core;
  for (sim::OpCost& cost : without.ops)
    if (!cost.routine) cost.issue = 0;
  return work.cost(core).total() - work.cost(without).total();
}

double slope(const StageOnOneCore& stage, double factor) {
  return stage.instructions / stage.with(factor);
}

double residual(const StageOnOneCore& stage, double factor) {
  return std::log(stage.with(factor) / stage.reference);
}

std::string percent(double simulated, double reference) {
  return fmt::format("{:+.1f} %", percent_error(simulated, reference));
}

}  // namespace

std::vector<StageOnOneCore> stages_on_one_core(const FrameLog& log, const sim::ChipConfig& chip) {
  const std::vector<Reference> references = paper_references();
  std::vector<StageOnOneCore> stages;
  for (const PaperStage& stage : kPaperStages) {
    const StageSum sum = sum_over(log.frames(), stage);
    if (sum.frames == 0)
      throw InputError(fmt::format(
          "no frame of the run came to {}; choose more frames or other data", stage.title));
    stages.push_back({stage.title, paper_cycles(references, stage.key), sum.mean_single().value(),
                      issued(sum.work, chip.cluster.core) / static_cast<double>(sum.frames)});
  }
  return stages;
}

FactorFit fit_factor(const std::vector<StageOnOneCore>& stages) {
  check(stages.size() > 1, "a fit with an error needs two stages");
  // Gauss-Newton over the logarithm of the factor, so that it stays positive.
  double factor = 1;
  double bend = 0;
  for (int i = 0; i < 50; ++i) {
    double pull = 0;
    bend = 0;
    for (const StageOnOneCore& stage : stages) {
      pull += residual(stage, factor) * slope(stage, factor) * factor;
      bend += std::pow(slope(stage, factor) * factor, 2);
    }
    check(bend > 0, "no stage has instructions");
    factor *= std::exp(-pull / bend);
  }
  double left = 0;
  for (const StageOnOneCore& stage : stages) left += std::pow(residual(stage, factor), 2);
  const double spread = left / static_cast<double>(stages.size() - 1);
  return {factor, factor * std::sqrt(spread / bend)};
}

double factor_without(const std::vector<StageOnOneCore>& stages, const StageOnOneCore& left_out) {
  std::vector<StageOnOneCore> others;
  for (const StageOnOneCore& stage : stages)
    if (&stage != &left_out) others.push_back(stage);
  return fit_factor(others).factor;
}

double percent_error(double simulated, double reference) {
  return 100 * (simulated / reference - 1);
}

double mean_error(const std::vector<StageOnOneCore>& stages, double factor) {
  double sum = 0;
  for (const StageOnOneCore& stage : stages)
    sum += std::abs(percent_error(stage.with(factor), stage.reference));
  return sum / static_cast<double>(stages.size());
}

std::string factor_table(const std::vector<StageOnOneCore>& stages) {
  const double factor = fit_factor(stages).factor;
  using S = const StageOnOneCore&;
  const Columns<StageOnOneCore> table{
      {{"stage, 1 core", kLeft}, [](S s) { return std::string(s.title); }},
      {{"paper, kcycles"}, [](S s) { return fmt::format("{:.0f}", s.reference / 1e3); }},
      {{"simulated"}, [](S s) { return fmt::format("{:.0f}", s.cycles / 1e3); }},
      {{"error"}, [](S s) { return percent(s.cycles, s.reference); }},
      {{"with the factor"}, [=](S s) { return percent(s.with(factor), s.reference); }},
      {{"the others' factor"},
       [&](S s) { return fmt::format("{:.3f}", factor_without(stages, s)); }},
      {{"with it"}, [&](S s) { return percent(s.with(factor_without(stages, s)), s.reference); }}};
  return "a factor on all instructions of compiled code, fitted to the single-core values by least "
         "squares of log ratios\n" +
         terminal_text(table_of(table, stages));
}

std::string factor_conclusion(const std::vector<StageOnOneCore>& stages) {
  const FactorFit fit = fit_factor(stages);
  return fmt::format(
      "in short: a fit would ask for a factor of {:.3f} ± {:.3f}, mean absolute error {:.1f} % "
      "instead of {:.1f} %; the model has none",
      fit.factor, fit.error, mean_error(stages, fit.factor), mean_error(stages, 1));
}

Json factor_json(const std::vector<StageOnOneCore>& stages) {
  const FactorFit fit = fit_factor(stages);
  Json document{{"format", "leviosim calibration"},
                {"version", 1},
                {"factor", fit.factor},
                {"standard_error", fit.error}};
  Json& list = document["stages"] = Json::array();
  for (const StageOnOneCore& stage : stages) {
    const double others = factor_without(stages, stage);
    list.push_back({{"stage", stage.title},
                    {"paper_cycles", stage.reference},
                    {"cycles", stage.cycles},
                    {"cycles_fitted", stage.with(fit.factor)},
                    {"factor_of_others", others},
                    {"cycles_predicted", stage.with(others)}});
  }
  return document;
}

}  // namespace leviosim::tools
