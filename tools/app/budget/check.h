// Checks a run against the limits of a budget: findings with the excess of a missed limit, where it
// was missed, and why.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// One limit on one statistic.
struct Finding {
  const Limit* limit;
  const BudgetSection* section;
  std::string statistic;
  std::string stage;  ///< its name; empty: the run as a whole
  std::string unit;   ///< of the statistic, as the values
  std::optional<double> value;
  std::optional<double> bound;     ///< absent if the baseline has no value
  std::optional<double> baseline;  ///< where the bound is relative to it
  std::string since = {};  ///< the run that it is relative to, where that is not the baseline's
  std::optional<double> before = {};  ///< value in the run before; only of limits that are not met
  std::string accepted = {};          ///< why it may be missed, and until when
  std::string expired = {};           ///< why it might be: the day is over, or it is missed by more
  bool met = false;
  std::string where;             ///< stage, fork, block; of what is not met
  std::vector<std::string> why;  ///< parts that explain it, the largest first

  /// The limit: "8-point RANSAC: cycles <= +3 %", with the statistic in place of a pattern.
  std::string title() const;
  /// Improvement on the baseline in per cent, where it exceeds what the limit allows for the worse:
  /// the baseline should then be renewed.
  std::optional<double> better() const;
  /// Whether it is not met, but no worse than in the run before.
  bool was_over() const;
  /// Whether it is not met and fails the check; other missed limits only warn.
  bool fails() const { return !met && !limit->warns && accepted.empty() && !was_over(); }
  /// By how much, and why it may or might be: "10259.8 kcycles, 5.84 % above 9693.3 kcycles".
  std::string excess() const;

 private:
  /// A figure in per cent, whose distance to its limit is in percentage points.
  bool is_share() const;
  std::string distance() const;
};

struct CheckResult {
  std::string run;
  std::string budget;    ///< file
  std::string baseline;  ///< empty: none
  std::vector<Finding> findings;
  std::vector<std::string> not_measured = {};  ///< limits on what a measurement has not
  bool is_kept = false;  ///< the baseline lies in a file, and does not move along with a history

  std::size_t missed() const;  ///< number of limits that fail the check
  std::size_t warned() const;  ///< number of limits that are not met, but only warn
  std::size_t better() const;  ///< number of figures that are better than the baseline's
};

/// @param budget    outlives the result
/// Of what was measured elsewhere, as the run or as the baseline, only limits on it are held.
/// @param baseline  comparable with the run; may be null if no limit is relative
/// @param beside    what a miss is explained by where there is no baseline: the same work on
/// another
///                  chip; may be null
/// @throws InputError for limits that cannot be held: unknown figures, units, a missing baseline
CheckResult check_budget(const RunRecord& run, const Budget& budget, const RunRecord* baseline,
                         const RunRecord* beside = nullptr);
/// @throws InputError at a limit that is relative
[[noreturn]] void fail_without_baseline(const Limit& limit);

}  // namespace leviosim::tools
