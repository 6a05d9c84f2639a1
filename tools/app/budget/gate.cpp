#include "tools/app/budget/gate.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/budget/baseline.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/cli/limit_not_met.h"

namespace leviosim::tools {
namespace {

/// Baselines are JSON, traces begin with letters.
bool is_baseline(const std::string& name) {
  if (!base::is_file(name) || name.size() < 5) return false;
  return name.substr(name.size() - 5) == ".json";
}

RunRecord read_any(const std::string& name, const RecordOptions& chip) {
  if (is_baseline(name))
    return parse_baseline(name, base::read_file(name, base::InputKind::baseline));
  if (base::is_folder(name)) return read_run_folder(name);
  return read_record(name, chip);
}

}  // namespace

void add_gate_options(CLI::App& command, GateOptions& options) {
  command.add_option("--budget", options.budget, "limits that the run has to meet")
      ->type_name("FILE");
  command
      .add_option("--baseline", options.baseline,
                  "what limits with a sign are relative to: a run, or what budget record printed")
      ->type_name("RUN|FILE.json");
  command
      .add_option("--allow", options.allow, "differences of the baseline's input that are meant")
      ->type_name("data,frames,profile,seed,size");
}

Gate::Gate(const GateOptions& options, const RecordOptions& chip)
    : budget_(read_budget(options.budget)), allowed_(parse_allowed(options.allow)) {
  if (!options.baseline.empty()) baseline_ = read_any(options.baseline, chip);
}

void Gate::use_baseline(RunRecord baseline) {
  if (!baseline_) baseline_ = std::move(baseline);
}

CheckResult Gate::check(const RunRecord& run) const {
  if (baseline_) check_comparable(*baseline_, run, allowed_);
  return check_budget(run, budget_, this->baseline());
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
