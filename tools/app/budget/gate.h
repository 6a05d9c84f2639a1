// A budget as a command holds a run against it: read before work is done, judged at the end. The
// baseline is a run, or the record of one with less in it (record.h, Level::kept).
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/record/record.h"
#include "tools/app/run/record_source.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// Names of the statistics that the limits for a run are about, to be kept in a baseline.
std::set<std::string> figures_in(const Budget& budget, const RunRecord& run);

struct GateOptions {
  std::string budget;
  std::string baseline;
  std::string allow;
};

/// What a command reads as a run: also a baseline, a file of `budget record`.
/// @throws InputError as read_record() and parse_record()
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

  /// @param beside  what explains a miss where there is no baseline; may be null
  /// @throws InputError as check_comparable() and check_budget()
  CheckResult check(const RunRecord& run, const RunRecord* beside = nullptr) const;

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
