#include "tools/app/budget/budget_edits.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "platform_models/loader/schema.h"
#include "sim/base/error.h"
#include "tools/app/budget/figures.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/result/verdict.h"

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

std::string parse_day(const std::string& where, const std::string& text) {
  std::tm day{};
  const char* const end = ::strptime(text.c_str(), "%Y-%m-%d", &day);
  if (end == nullptr || *end != '\0' || text.size() != 10)
    throw InputError(fmt::format("{} '{}': expected a day such as 2026-12-24", where, text));
  return text;
}

std::string today() {
  const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t now = epoch == nullptr ? std::time(nullptr) : std::atoll(epoch);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

std::string with_accepted(const std::string& text, const CheckResult& result,
                          const std::string& reason, const std::string& until) {
  std::string entries;
  const auto quoted = [](const std::string& words) { return json_text(Json(words)); };
  for (const Finding& finding : result.findings)
    if (finding.fails())
      entries += fmt::format("  - limit: {}\n    reason: {}\n    until: {}\n",
                             quoted(finding.title()), quoted(reason),
                             parse_day("--until", until));
  if (entries.empty())
    throw InputError(
        fmt::format("budget accept: {} meets all limits of {}", result.run, result.budget));
  std::string edited = text;
  if (!edited.empty() && edited.back() != '\n') edited += '\n';
  const std::size_t at = edited.find("\n" + std::string(kAccepted));
  if (at == std::string::npos) return edited + std::string(kAccepted) + entries;
  return edited.insert(at + 1 + kAccepted.size(), entries);
}

namespace {

struct FirstLimit {
  const char* figure;
  const char* statistic;
  double scale;  ///< from the statistic's unit
  const char* unit;
  int decimals;
};
constexpr std::array kFirstLimits{
    FirstLimit{"frame time p99", "frame.time.p99", 1e-6, "ms", 2},
    FirstLimit{"missed", "frame.missed_share", 100, "%", 2},
    FirstLimit{"frame cycles", "frame.cycles.parallel.mean", 1e-3, "kcycles", 1},
    FirstLimit{"L1 peak", "memory.l1.peak", 1e-3, "kB", 1},
    FirstLimit{"L2 peak", "memory.l2.peak", 1e-3, "kB", 1},
    FirstLimit{"energy per frame", "energy.frame", 1, "mJ", 4},
    FirstLimit{"ATE", "accuracy.ate.rmse", 1, "m", 4},
};

/// Not below the value, though it is rounded.
std::string rounded_up(double value, int decimals) {
  const double scale = std::pow(10, decimals);
  // A share of what is exact as written must not grow by a digit; no negative zero.
  const double digits = std::max(0.0, std::ceil(value * scale - 1e-6));
  return fmt::format("{:.{}f}", digits / scale, decimals);
}

}  // namespace

std::string first_budget(const RunRecord& run, double margin) {
  const double factor = 1 + margin / 100;
  const auto quoted = [](const std::string& text) { return json_text(Json(text)); };
  std::string text = fmt::format(
      "# What the run needs, and {:g} % more. Give each limit its reason and owner.\n"
      "budgets:\n  - name: {}\n    platform: {}\n    profile: {}\n    limits:\n",
      margin, quoted(run.facts.profile + " on " + run.facts.platform), quoted(run.facts.platform),
      quoted(run.facts.profile));
  for (const FirstLimit& limit : kFirstLimits)
    if (const auto value = run.value(limit.statistic))
      text += fmt::format("      - {} <= {} {}\n", limit.figure,
                          rounded_up(*value * limit.scale * factor, limit.decimals), limit.unit);
  for (const RunVerdict& verdict : verdicts(run).list)  // a budget that says nothing refuses these
    if (verdict.grade == Grade::bad)
      text += fmt::format("      - {} verdict <= {}\n", verdict.about, verdict.word());
  for (const StageName& stage : run.stages)
    if (const auto value = run.value(fmt::format("stages.{}.cycles.parallel.mean", stage.key)))
      text += fmt::format("      - stage: {}\n        limit: cycles <= {} kcycles\n",
                          quoted(stage.name), rounded_up(*value * 1e-3 * factor, 1));
  return text;
}

double parse_share(const std::string& option, const std::string& text) {
  const auto measure = platform::split_measure(text);
  if (!measure || measure->unit != "%" || !(measure->number >= 0 && measure->number <= 1000))
    throw InputError(
        fmt::format("{} '{}': expected a share from 0 to 1000 %, such as 5 %", option, text));
  return measure->number;
}

}  // namespace leviosim::tools
