#include "tools/app/budget/budget_edits.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/day.h"
#include "tools/app/budget/figures.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kAccepted = "accepted:\n";

/// What leaves most of the room of a limit unused: the largest value for "<=", else the least.
std::optional<double> needed(const Limit& limit, const RunRecord& run) {
  std::optional<double> most;
  for (const FigureOf& figure : figures_of(limit, run)) {
    const auto value = figure.statistic->value;
    if (value && (!most || (limit.bound.at_most ? *value > *most : *value < *most))) most = value;
  }
  return most;
}

/// Four digits, never to the wrong side of the value.
std::string rounded_to_side(double value, bool up) {
  if (value == 0) return "0";
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 3);
  const double steps = value / unit;
  const double whole = up ? std::ceil(steps - 1e-9) : std::floor(steps + 1e-9);
  return fmt::format("{:.10g}", whole * unit);
}

/// The limit's text with another number.
std::string with_number(const Limit& limit, const std::string& number) {
  const std::string unit = limit.bound.unit.empty() ? "" : " " + limit.bound.unit;
  return fmt::format("{} {} {}{}", limit.figure, limit.bound.at_most ? "<=" : ">=", number, unit);
}

/// The value found and a margin beyond it, in the unit of the limit, or as people read the value.
std::string bound_beyond(const Finding& finding, double margin) {
  const bool up = finding.limit->bound.at_most;
  const double wanted = *finding.value + (up ? 1 : -1) * std::abs(*finding.value) * margin / 100;
  Limit one = *finding.limit;
  if (is_percent_of_baseline(one.bound)) one.bound.unit = shown_unit(finding.unit).name;
  one.bound.number = 1;
  one.bound.relative = false;
  const std::string number = rounded_to_side(wanted / bound_in(one, finding.unit), up);
  return one.bound.unit.empty() ? number : fmt::format("{} {}", number, one.bound.unit);
}

/// Those that fail and are named; without names, the one that fails.
std::vector<const Finding*> accepted_misses(const CheckResult& result,
                                            const std::vector<std::string>& names) {
  std::vector<const Finding*> failing;
  std::vector<std::string> titles;
  for (const Finding& finding : result.findings)
    if (finding.fails()) failing.push_back(&finding), titles.push_back(finding.title());
  if (failing.empty())
    throw InputError(
        fmt::format("budget accept: {} meets all limits of {}", result.run, result.budget));
  if (names.empty() && failing.size() > 1)
    throw InputError(fmt::format("budget accept: {} limits fail; expected --limit with one of '{}'",
                                 failing.size(), fmt::join(titles, "', '")));
  if (names.empty()) return failing;
  std::vector<const Finding*> chosen;
  for (const std::string& name : names) {
    const auto at = std::find(titles.begin(), titles.end(), name);
    if (at == titles.end())
      throw InputError(fmt::format("--limit '{}': is no limit that fails; expected one of '{}'{}",
                                   name, fmt::join(titles, "', '"),
                                   base::did_you_mean(name, titles)));
    chosen.push_back(failing[static_cast<std::size_t>(at - titles.begin())]);
  }
  return chosen;
}

}  // namespace

std::string tightened(const Budget& budget, const std::string& text, const RunRecord& run,
                      double slack) {
  std::string edited = text;
  for (const BudgetSection* section : sections_for(budget, run))
    for (const Limit& limit : section->limits) {
      if (limit.bound.relative || !limit.bound.word.empty()) continue;
      const auto value = needed(limit, run);
      if (!value) continue;
      const std::string unit = figures_of(limit, run).front().statistic->unit;
      const bool up = limit.bound.at_most;
      const double wanted = *value * (1 + (up ? slack : -slack) / 100);
      const double bound = bound_in(limit, unit);
      if (up ? wanted >= bound : wanted <= bound) continue;
      Limit one = limit;
      one.bound.number = 1;
      // Lines before this one are as they were: entries are edited in place.
      std::size_t at = 0;
      for (int line = 1; line < limit.line; ++line) at = edited.find('\n', at) + 1;
      at = edited.find(limit.text, at);
      if (at == std::string::npos) continue;  // quoted with escapes
      edited.replace(at, limit.text.size(),
                     with_number(limit, rounded_to_side(wanted / bound_in(one, unit), up)));
    }
  return edited;
}

std::string with_accepted(const std::string& text, const CheckResult& result,
                          const Acceptance& acceptance) {
  const std::string day = parse_day("--until", acceptance.until);
  const auto quoted = [](const std::string& words) { return json_text(Json(words)); };
  std::string entries;
  for (const Finding* finding : accepted_misses(result, acceptance.limits)) {
    entries += fmt::format("  - limit: {}\n", quoted(finding->title()));
    if (finding->value && finding->limit->bound.word.empty())
      entries += fmt::format("    bound: {}\n", bound_beyond(*finding, acceptance.margin));
    entries += fmt::format("    reason: {}\n    until: {}\n", quoted(acceptance.reason), day);
  }
  std::string edited = text;
  if (!edited.empty() && edited.back() != '\n') edited += '\n';
  const std::size_t at = edited.find("\n" + std::string(kAccepted));
  if (at == std::string::npos) return edited + std::string(kAccepted) + entries;
  return edited.insert(at + 1 + kAccepted.size(), entries);
}

}  // namespace leviosim::tools
