// Holds a run against the limits of a budget: what was found, by how much a limit is missed, where,
// and why.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/record/record.h"
#include "tools/app/record/statistic_list.h"

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
  std::optional<double> before = {};  ///< of what is not met: in the run before, where one is known
  std::string accepted = {};          ///< why it may be missed, and until when
  std::string expired = {};           ///< why it might be, until a day that is over
  bool met = false;
  std::string where;             ///< stage, fork, block; of what is not met
  std::vector<std::string> why;  ///< parts that explain it, the largest first

  /// What is held: "8-point RANSAC: cycles <= +3 %", with the statistic in place of a pattern.
  std::string title() const;
  /// By how much it is better than the baseline, in per cent, where that is more than the limit
  /// allows the other way: the limit no longer holds what was won.
  std::optional<double> better() const;
  /// Whether it is not met, but no worse than in the run before.
  bool was_over() const;
  /// Whether it is not met and fails the check; else a warning is all that it is.
  bool fails() const { return !met && !limit->warns && accepted.empty() && !was_over(); }
  /// By how much, and why it may or might be: "10259.8 kcycles, 5.84 % above 9693.3 kcycles".
  std::string excess() const;

 private:
  std::string distance() const;
};

struct CheckResult {
  std::string run;
  std::string budget;    ///< file
  std::string baseline;  ///< empty: none
  std::vector<Finding> findings;
  std::vector<std::string> not_measured = {};  ///< limits on what a measurement has not
  bool is_kept = false;  ///< the baseline lies in a file, and does not move along with a history

  std::size_t missed() const;  ///< that fail the check
  std::size_t warned() const;  ///< that are not met, but do not
  std::size_t better() const;  ///< than the baseline
};

/// @param budget    outlives the result
/// Of what was measured elsewhere, as the run or as the baseline, only limits on it are held.
/// @param baseline  comparable with the run; may be null if no limit is relative
/// @throws InputError for limits that cannot be held: unknown figures, units, a missing baseline
CheckResult check_budget(const RunRecord& run, const Budget& budget, const RunRecord* baseline);
/// @throws InputError at a limit that is relative
[[noreturn]] void fail_without_baseline(const Limit& limit);

// Where a limit was missed, and why: the stage, what its cores did and by which mechanism, or the
// blocks of a memory; against the baseline if there is one, else what weighs most in the run.

/// Fills in `where` and `why` of the findings that are not met.
/// @param baseline  may be null
void explain(CheckResult& result, const RunRecord& run, const RunRecord* baseline);

// What a check found, as text of 80 columns, as JSON, and as CI servers read it.

/// A line per limit, and for those that are not met by how much, where, why, reason and owner, as
/// parts of a screen, with a verdict at their end.
/// @param next  what to do about limits that are not met
Printout check_printout(const CheckResult& result, std::vector<std::string> next);

Json check_json(const CheckResult& result);

// What a check found, as CI servers read it: JUnit, annotations of GitHub, a code quality report of
// GitLab. No times of the host: the same findings are the same bytes.

/// A suite per section, a case per limit and statistic.
std::string junit_xml(const CheckResult& result);

/// A comment on a pull request: the verdicts of the run, what of the limits is not met and why,
/// what moved against the baseline, and all limits folded away.
/// @param baseline  may be null
std::string markdown_comment(const CheckResult& result, const RunRecord& run,
                             const RunRecord* baseline);

/// "::error file=…,line=…,title=…::…" for each limit that is not met.
std::string github_annotations(const CheckResult& result);

/// The JSON that GitLab reads as an artifact of the kind codequality.
std::string gitlab_report(const CheckResult& result);

// Changes of a file of budgets that people review: limits that lost their slack, and regressions
// that are accepted until a day. What else stands in the file stays as it is, comments included.

/// The file with absolute limits that leave no more than `slack` per cent of what the run needs;
/// tighter ones stay. @param text  of the budget's file
std::string tightened(const Budget& budget, const std::string& text, const RunRecord& run,
                      double slack);

/// The file with an entry under `accepted` for each limit that fails.
/// @throws InputError for a day that is none, and if no limit fails
std::string with_accepted(const std::string& text, const CheckResult& result,
                          const std::string& reason, const std::string& until);

/// "2026-12-24". @throws InputError that begins with `where`
std::string parse_day(const std::string& where, const std::string& text);

/// Of the clock in UTC, or what SOURCE_DATE_EPOCH in the environment says.
std::string today();

// A first budget for a run: what it needs today and a margin, to be edited by people.

/// The text of a budget file that the run meets. @param margin  in per cent
std::string first_budget(const RunRecord& run, double margin);

/// "5 %". @throws InputError that names the option, unless it is a share from 0 to 1000 %
double parse_share(const std::string& option, const std::string& text);

}  // namespace leviosim::tools
