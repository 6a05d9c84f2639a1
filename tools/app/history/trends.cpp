// Steps and drifts of figures over the runs of a history, part of history.h.
#include "tools/app/history/trends.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/app/budget/figures.h"
#include "tools/app/budget/gate.h"
#include "tools/app/budget/reasons.h"
#include "tools/app/history/history.h"

namespace leviosim::tools {
namespace {

/// A change for the worse by as much as a limit allows meets it, whatever its last digit.
constexpr double kRounding = 1e-9;

/// For the worse, in per cent; absent where one of them is, and of nothing.
std::optional<double> change_of(const std::optional<double>& before,
                                const std::optional<double>& now, bool at_most) {
  if (!before || !now || *before == 0) return std::nullopt;
  return 100 * (*now - *before) / std::abs(*before) * (at_most ? 1 : -1);
}

/// Sorts the changes of a figure into steps and drift.
void find_changes(Trend& trend) {
  std::optional<double> last;
  for (std::size_t i = 0; i < trend.values.size(); ++i) {
    const auto change = change_of(last, trend.values[i], trend.limit->bound.at_most);
    if (trend.values[i]) last = trend.values[i];
    if (!change || *change == 0) continue;
    if (*change > trend.allowed + kRounding)
      trend.steps.push_back({i, *change});
    else
      trend.drift.push_back({i, *change});
  }
  const double worse = trend.limit->bound.at_most ? 1 : -1;
  double ratio = 1;
  for (const FigureChange& change : trend.drift) ratio *= 1 + worse * change.percent / 100;
  trend.drift_percent = 100 * worse * (ratio - 1);
  if (trend.drift_percent <= trend.allowed + kRounding) trend.drift.clear();
}

Trend trend_of(const Limit& limit, const BudgetSection& section, const FigureOf& figure,
               const std::vector<PastRun>& runs) {
  Trend trend;
  trend.limit = &limit;
  trend.section = &section;
  trend.statistic = figure.statistic->name;
  trend.stage = figure.stage;
  trend.unit = figure.statistic->unit;
  trend.allowed = limit.bound.number * (limit.bound.at_most ? 1 : -1);
  for (const PastRun& run : runs) trend.values.push_back(run.record.value(trend.statistic));
  find_changes(trend);
  return trend;
}

/// How the commit of a step explains it, by the run before.
std::vector<std::string> reasons_of(const Trend& trend, std::size_t run,
                                    const std::vector<PastRun>& runs) {
  CheckResult step;
  Finding& finding = step.findings.emplace_back();
  finding.limit = trend.limit;
  finding.section = trend.section;
  finding.statistic = trend.statistic;
  finding.stage = trend.stage;
  explain(step, runs[run].record, &runs[run - 1].record);
  std::vector<std::string> texts{finding.where};
  for (const std::string& why : finding.why) texts.push_back(why);
  return texts;
}

/// The trend as a limit that is not met since the first of the runs.
Finding finding_of(const Trend& trend, const std::vector<PastRun>& runs) {
  Finding f;
  f.limit = trend.limit;
  f.section = trend.section;
  f.statistic = trend.statistic;
  f.stage = trend.stage;
  f.unit = trend.unit;
  f.value = trend.values.back();
  f.since = runs.front().record.name;
  const auto first = std::find_if(trend.values.begin(), trend.values.end(),
                                  [](const std::optional<double>& v) { return v.has_value(); });
  f.baseline = *first;
  f.bound = **first * (1 + trend.limit->bound.number / 100);
  return f;
}

}  // namespace

std::vector<Trend> trends(const Budget& budget, const std::vector<PastRun>& runs) {
  std::vector<Trend> found;
  if (runs.empty()) return found;
  const RunRecord& last = runs.back().record;
  for (const BudgetSection* section : sections_for(budget, last))
    for (const Limit& limit : section->limits) {
      if (!is_percent_of_baseline(limit.bound)) continue;
      for (const FigureOf& figure : find_figures(limit, last))
        found.push_back(trend_of(limit, *section, figure, runs));
    }
  return found;
}

std::string drift_text(const Trend& trend, const std::vector<PastRun>& runs) {
  double most = 0;
  for (const FigureChange& change : trend.drift) most = std::max(most, change.percent);
  return fmt::format("drift of {:+.2f} % in {} commits from {} to {}, none above {:+.2f} %",
                     trend.drift_percent, trend.drift.size(),
                     runs[trend.drift.front().run].record.name,
                     runs[trend.drift.back().run].record.name, most);
}

std::string step_text(const Trend& trend, const FigureChange& step,
                      const std::vector<PastRun>& runs) {
  const Origin& origin = runs[step.run].origin;
  std::string text =
      fmt::format("step of {:+.2f} % at {}", step.percent, runs[step.run].record.name);
  if (!origin.subject.empty()) text += fmt::format(" ({})", origin.subject);
  const char* separator = ": ";
  for (const std::string& reason : reasons_of(trend, step.run, runs)) {
    text += separator + reason;
    separator = "; ";
  }
  return text;
}

void add_history(CheckResult& result, const RunRecord& run, const Budget& budget,
                 const std::vector<PastRun>& before) {
  if (before.empty()) return;
  const RunRecord& last = before.back().record;
  for (Finding& finding : result.findings)
    if (!finding.met) finding.before = last.value(finding.statistic);
  std::vector<PastRun> all = before;
  all.push_back({{}, {}, run});
  for (const Trend& trend : trends(budget, all)) {
    Finding finding = finding_of(trend, all);
    const auto total = change_of(finding.baseline, finding.value, trend.limit->bound.at_most);
    const bool is_said =
        std::any_of(result.findings.begin(), result.findings.end(), [&](const Finding& f) {
          return !f.met && f.statistic == trend.statistic && f.limit == trend.limit;
        });
    if (is_said || !total || *total <= trend.allowed + kRounding ||
        (trend.steps.empty() && trend.drift.empty()))
      continue;
    CheckResult over_time;
    over_time.findings.push_back(finding);
    explain(over_time, run, &all.front().record);
    finding.where = over_time.findings.front().where;
    for (const FigureChange& step : trend.steps) finding.why.push_back(step_text(trend, step, all));
    if (!trend.drift.empty()) finding.why.push_back(drift_text(trend, all));
    finding.before = last.value(trend.statistic);
    result.findings.push_back(std::move(finding));
  }
}

}  // namespace leviosim::tools
