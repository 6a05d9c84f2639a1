// Trends of a budget's figures over many runs. Runs have no noise: every change of a
// figure is one of a commit. A change beyond a limit is a step; smaller ones that are beyond it
// together are a drift, which no comparison with the run before shows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/history/history.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// A change of a figure from one run to the next.
struct FigureChange {
  std::size_t run = 0;  ///< run with the new value
  double percent = 0;   ///< change in per cent of the value before; above 0: worse
};

/// A figure over runs, the oldest first, held against a limit in per cent of a baseline.
struct Trend {
  const Limit* limit = nullptr;
  const BudgetSection* section = nullptr;
  std::string statistic;
  std::string stage;  ///< its name; empty: the run as a whole
  std::string unit;
  std::vector<std::optional<double>> values;
  double allowed = 0;               ///< largest change for the worse [%]
  std::vector<FigureChange> steps;  ///< changes for the worse beyond the limit
  std::vector<FigureChange> drift;  ///< the others, if they are beyond it together; else none
  double drift_percent = 0;         ///< their sum
};

/// Of every limit with a sign and %, for figures that some of the runs have. The budget outlives
/// the trends.
std::vector<Trend> trends(const Budget& budget, const std::vector<PastRun>& runs);

/// "drift of +2.0 % in 10 commits, none above +0.2 %: 8f3c2a1 … 99ab01c".
std::string drift_text(const Trend& trend, const std::vector<PastRun>& runs);
/// "step of +3.0 % at 8f3c2a1 (make EPnP exact): solve EPnP: issue: f64_add +2.9 %".
std::string step_text(const Trend& trend, const FigureChange& step,
                      const std::vector<PastRun>& runs);

/// Adds findings from earlier runs to a check: limits that are met only because the baseline moved
/// along, and, of limits that are not met, whether they were met before.
/// @param before  runs like it, the oldest first; may be none
void add_history(CheckResult& result, const RunRecord& run, const Budget& budget,
                 const std::vector<PastRun>& before);

}  // namespace leviosim::tools
