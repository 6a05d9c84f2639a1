#include "tools/app/budget/gate.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <set>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/budget/figures.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/measured.h"

namespace leviosim::tools {
namespace {

/// Baselines are JSON, traces begin with letters.
bool is_baseline(const std::string& name) { return base::is_file(name) && name.ends_with(".json"); }

}  // namespace

std::set<std::string> figures_in(const Budget& budget, const RunRecord& run) {
  std::set<std::string> names;
  for (const BudgetSection* section : sections_for(budget, run))
    for (const Limit& limit : section->limits)
      for (const FigureOf& figure : figures_of(limit, run)) names.insert(figure.statistic->name);
  return names;
}

RunRecord read_run_or_baseline(const std::string& name, const RecordOptions& chip) {
  if (is_baseline(name))
    return parse_record(name, base::read_file(name, base::InputKind::baseline), Level::kept);
  return read_record(name, chip);
}

void add_gate_options(CLI::App& command, GateOptions& options) {
  const TextOptions add{command};
  add("--budget", options.budget, "FILE", "limits that the run has to meet");
  add("--baseline", options.baseline, "RUN|FILE.json",
      "reference of limits with a sign: a run, or what budget record printed");
  add("--allow", options.allow, "chip,data,frames,profile,seed,size",
      "differences of the baseline's input that are intended");
}

Gate::Gate(const GateOptions& options, const RecordOptions& chip)
    : budget_(read_budget(options.budget)), allowed_(parse_allowed(options.allow)) {
  if (options.baseline.empty()) return;
  is_kept_ = true;
  if (base::is_folder(options.baseline) || is_measured(options.baseline))
    baseline_ = read_record(options.baseline, {});
  else if (options.baseline.ends_with(".yaml") && base::is_file(options.baseline))
    throw InputError(fmt::format(
        "--baseline {}: is no baseline; expected a run folder, a work trace, or a JSON file that "
        "'leviosim budget record' printed",
        options.baseline));
  else
    baseline_ = read_run_or_baseline(options.baseline, chip);
}

void Gate::use_baseline(RunRecord baseline) {
  if (!baseline_) baseline_ = std::move(baseline);
}

CheckResult Gate::check(const RunRecord& of, const RunRecord* beside) const {
  RunRecord run = of;
  std::optional<RunRecord> baseline = baseline_;
  if (baseline) {
    check_comparable(*baseline, run, allowed_);
    check_same_chip(*baseline, run, allowed_);
    name_stages_like(run, *baseline);
    name_stages_like(*baseline, run);
  }
  CheckResult result = check_budget(run, budget_, baseline ? &*baseline : nullptr, beside);
  result.is_kept = is_kept_;
  return result;
}

std::optional<Gate> optional_gate(const GateOptions& options, const RecordOptions& chip) {
  if (!options.budget.empty()) return Gate(options, chip);
  if (!options.baseline.empty())
    throw InputError("--baseline is for a budget; expected --budget as well");
  return std::nullopt;
}

void print_check(const CheckResult& result) {
  print(check_printout(result, {}));
  if (result.missed() > 0) throw LimitNotMet();
}

}  // namespace leviosim::tools
