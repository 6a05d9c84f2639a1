// A baseline: what a budget needs of an earlier run, in a few kilobytes of JSON with a figure on a
// line, made for version control. It holds the facts of the run, the figures that most limits are
// about, those that a budget names, the blocks at the highest peak of L1, and the larger parts of
// every stage's cycles; parts below one per cent of a stage are one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/run_record.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// A figure that is not a stage's, and its value: whole numbers without a fraction, or null.
struct BaselineFigure {
  std::string name;
  std::string unit;
  Json value;
};
/// What a baseline without a budget holds, in two parts: figures of the run, and stages with theirs
/// and the larger parts of their cycles, if they have any. @throws InputError if it is not known
/// where cycles went
std::vector<BaselineFigure> baseline_figures(const RunRecord& run);
std::vector<Json> baseline_stages(const RunRecord& run);
/// The inverse of the second: adds the stage, its figures and its cycles.
/// @throws nlohmann::json::exception, InputError for what is no such stage
void add_baseline_stage(const Json& stage, RunRecord& run);

/// The text of a baseline. @param budget  whose further statistics it holds too; may be null
std::string baseline_text(const RunRecord& run, const Budget* budget);

/// @throws InputError for what is no baseline
RunRecord parse_baseline(const std::string& name, const std::string& text);

// A budget as a command holds a run against it: read before work is done, judged at the end.

struct GateOptions {
  std::string budget;
  std::string baseline;
  std::string allow;
};

/// What a command reads as a run: also a baseline, a file of `budget record`.
/// @throws InputError as read_record() and parse_baseline()
RunRecord read_run_or_baseline(const std::string& name, const RecordOptions& chip);

/// Declares --budget, --baseline and --allow.
void add_gate_options(CLI::App& command, GateOptions& options);

class Gate {
 public:
  /// Reads budget and baseline: a file of `budget record`, a run folder, or a trace.
  /// @param chip  on which a trace is replayed
  /// @throws InputError for what is no baseline, or names another run
  Gate(const GateOptions& options, const RecordOptions& chip);

  /// A baseline where none was named; one that was named stays. It moves along, and cannot be
  /// stale.
  void use_baseline(RunRecord baseline);
  const Budget& budget() const { return budget_; }
  /// Null if there is none.
  const RunRecord* baseline() const { return baseline_ ? &*baseline_ : nullptr; }

  /// @throws InputError as check_comparable() and check_budget()
  CheckResult check(const RunRecord& run) const;

 private:
  Budget budget_;
  Allowed allowed_;
  std::optional<RunRecord> baseline_;
  bool is_kept_ = false;
};

/// The gate of a command that does something else; none without --budget.
std::optional<Gate> optional_gate(const GateOptions& options, const RecordOptions& chip);

/// Prints what a gate says of a run. @throws LimitNotMet if a limit is not met
void print_check(const CheckResult& result);

}  // namespace leviosim::tools
