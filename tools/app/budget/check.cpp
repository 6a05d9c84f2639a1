#include "tools/app/budget/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "platform_models/loader/yaml_entries.h"
#include "sim/base/error.h"
#include "tools/app/budget/day.h"
#include "tools/app/budget/figures.h"
#include "tools/app/budget/reasons.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/record/measured.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

/// No limit is missed by the conversion of its unit: 30 ms are not exactly 3e7 ns.
constexpr double kRounding = 1e-12;

/// What a relative limit comes to.
std::optional<double> relative_bound(const Limit& limit, const Statistic& statistic,
                                     double baseline) {
  const double number = bound_in(limit, statistic.unit);
  return is_percent_of_baseline(limit.bound) ? baseline * (1 + number / 100) : baseline + number;
}

/// Whether the baseline ran without that stage.
bool is_new_stage(const FigureOf& figure, const RunRecord& baseline) {
  return !figure.stage.empty() &&
         std::none_of(baseline.stages.begin(), baseline.stages.end(),
                      [&](const StageName& stage) { return stage.name == figure.stage; });
}

/// What a limit is about; of a measurement, what of it was measured.
std::vector<FigureOf> figures_held(const Limit& limit, const RunRecord& run,
                                   const RunRecord* baseline) {
  std::vector<FigureOf> figures =
      run.facts.measured ? find_figures(limit, run) : figures_of(limit, run);
  if (baseline != nullptr && limit.bound.relative &&
      (run.facts.measured || baseline->facts.measured))
    std::erase_if(figures, [&](const FigureOf& figure) {
      return baseline->find(figure.statistic->name) == nullptr;
    });
  return figures;
}

/// Where a figure has no value in the run nor in the baseline.
bool is_idle(const Finding& f) { return !f.value && (!f.limit->bound.relative || !f.baseline); }

Finding hold(const Limit& limit, const FigureOf& figure, const RunRecord* baseline) {
  Finding f;
  f.limit = &limit;
  f.statistic = figure.statistic->name;
  f.stage = figure.stage;
  f.unit = figure.statistic->unit;
  f.value = figure.statistic->value;
  if (limit.bound.relative) {
    const platform::Place place = platform::place_of(limit.file, limit.line, "");
    if (baseline == nullptr) fail_without_baseline(limit);
    if (baseline->find(f.statistic) == nullptr && !is_new_stage(figure, *baseline))
      place.fail(
          fmt::format("{} has no {}; record it with this budget: leviosim budget record RUN "
                      "--budget {}",
                      baseline->name, f.statistic, limit.file));
    f.baseline = baseline->value(f.statistic);
    if (f.baseline) f.bound = relative_bound(limit, *figure.statistic, *f.baseline);
  } else {
    f.bound = bound_in(limit, f.unit);
  }
  if (f.value && f.bound) {
    const double over = limit.bound.at_most ? *f.value - *f.bound : *f.bound - *f.value;
    f.met = over <= kRounding * std::abs(*f.bound);
  }
  // Of a stage that neither run called, nothing changed.
  if (limit.bound.relative && !f.stage.empty() && is_idle(f)) f.met = true;
  return f;
}

/// Verdicts that are the worst although no limit allows it.
void add_bad_verdicts(CheckResult& result, const RunRecord& run, const Budget& budget) {
  for (const Limit& limit : budget.verdicts.limits) {
    const bool is_named = std::any_of(result.findings.begin(), result.findings.end(),
                                      [&](const Finding& f) { return f.unit == limit.figure; });
    if (is_named || run.find(fmt::format(
                        "verdict.{}", limit.figure.substr(0, limit.figure.find(' ')))) == nullptr)
      continue;
    const FigureOf figure = figures_of(limit, run).front();
    if (figure.statistic->value != severity(Grade::bad)) continue;
    Finding finding = hold(limit, figure, nullptr);
    finding.section = &budget.verdicts;
    for (const RunVerdict& verdict : run.verdicts.list)
      if (figure.statistic->name == fmt::format("verdict.{}", verdict.about))
        finding.why = verdict.reasons;
    result.findings.push_back(std::move(finding));
  }
}

/// Whether a value that misses its limit is within the bound that was accepted instead.
bool is_within(const Finding& f, const AcceptedMiss& miss, const Budget& budget) {
  if (!miss.bound) return !f.value || !f.limit->bound.word.empty();
  if (!f.value) return false;
  Limit other = *f.limit;
  other.bound.relative = false;
  other.bound.number = miss.bound->number;
  other.bound.unit = miss.bound->unit;
  other.file = budget.file;
  other.line = miss.line;
  const double bound = bound_in(other, f.unit);
  return f.limit->bound.at_most ? *f.value <= bound : *f.value >= bound;
}

void accept(Finding& f, const AcceptedMiss& miss, const Budget& budget) {
  const std::string up_to =
      miss.bound
          ? fmt::format(" {} {:g}{}{}", f.limit->bound.at_most ? "up to" : "down to",
                        miss.bound->number, miss.bound->unit.empty() ? "" : " ", miss.bound->unit)
          : std::string();
  const bool within = is_within(f, miss, budget);
  if (today() > miss.until)
    f.expired = fmt::format("was accepted{} until {}: {}", up_to, miss.until, miss.reason);
  else if (within)
    f.accepted = fmt::format("accepted{} until {}: {}", up_to, miss.until, miss.reason);
  else
    f.expired = miss.bound
                    ? fmt::format("was accepted{} only: {}", up_to, miss.reason)
                    : fmt::format("its entry under 'accepted' has no bound: {}", miss.reason);
}

}  // namespace

std::string Finding::title() const {
  const std::string end = since.empty() ? std::string() : " since " + since;
  if (!limit->stage.empty()) return stage + ": " + limit->text + end;
  if (limit->figure.find('*') == std::string::npos) return limit->text + end;
  return statistic + limit->text.substr(limit->figure.size()) + end;
}

bool Finding::was_over() const {
  if (met || !before || !value || !bound) return false;
  const auto over = [&](double v) { return limit->bound.at_most ? v > *bound : v < *bound; };
  return over(*before) && (limit->bound.at_most ? *value <= *before : *value >= *before);
}

std::optional<double> Finding::better() const {
  if (!met || !value || !baseline || *baseline == 0 || !is_percent_of_baseline(limit->bound))
    return std::nullopt;
  const double side = limit->bound.at_most ? 1 : -1;
  const double percent = side * 100 * (*baseline - *value) / std::abs(*baseline);
  const double allowed = std::max(side * limit->bound.number, 0.0);
  return percent > allowed + kRounding ? std::optional(percent) : std::nullopt;
}

bool Finding::is_share() const {
  return unit == "%" || (unit == "1" && !limit->bound.relative &&
                         (limit->bound.unit == "%" || statistic.ends_with("share")));
}

std::string Finding::distance() const {
  if (!value) return "the run has no such value";
  const std::string found = figure_text(*value, unit, limit->bound);
  if (!bound) return found + ", but the baseline has no value of it";
  if (!limit->bound.word.empty())
    return fmt::format("{}, worse than {}", found, figure_text(*bound, unit, limit->bound));
  const double over = *value - *bound;
  const std::string limit_text = figure_text(*bound, unit, limit->bound);
  const char* side = over > 0 ? "above" : over < 0 ? "below" : "at";
  std::string text = over == 0     ? fmt::format("{}, at the limit", found)
                     : *bound == 0 ? fmt::format("{}, {} {}", found, side, limit_text)
                     : is_share()
                         ? fmt::format("{}, {:.2f} percentage points {} {}", found,
                                       std::abs(over) * (unit == "%" ? 1 : 100), side, limit_text)
                         : fmt::format("{}, {:.2f} % {} {}", found, 100 * std::abs(over / *bound),
                                       side, limit_text);
  if (baseline && *baseline != 0)
    text +=
        fmt::format("; {:+.2f} % of {} {}", 100 * (*value - *baseline) / *baseline,
                    since.empty() ? "the baseline's" : since + "'s", figure_text(*baseline, unit));
  return text;
}

std::string Finding::excess() const {
  std::string text = distance();
  if (const std::string& words = accepted.empty() ? expired : accepted; !words.empty())
    text += "; " + words;
  return was_over() ? text + "; was over before this change" : text;
}

std::size_t CheckResult::missed() const {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.fails(); }));
}

std::size_t CheckResult::warned() const {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [](const Finding& f) { return !f.met && !f.fails(); }));
}

std::size_t CheckResult::better() const {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.better(); }));
}

void fail_without_baseline(const Limit& limit) {
  platform::place_of(limit.file, limit.line, "")
      .fail(fmt::format("'{}' is relative to a baseline; expected --baseline", limit.text));
}

CheckResult check_budget(const RunRecord& run, const Budget& budget, const RunRecord* baseline,
                         const RunRecord* beside) {
  CheckResult result{run.name, budget.file, baseline == nullptr ? "" : baseline->name, {}};
  for (const BudgetSection* section : sections_for(budget, run))
    for (const Limit& limit : section->limits) {
      const std::vector<FigureOf> figures = figures_held(limit, run, baseline);
      if (figures.empty()) result.not_measured.push_back(limit.text);
      for (const FigureOf& figure : figures) {
        Finding finding = hold(limit, figure, baseline);
        // Of several kinds of frames, some never come.
        if (figures.size() > 1 && figure.stage.empty() && is_idle(finding)) continue;
        finding.section = section;
        result.findings.push_back(std::move(finding));
      }
    }
  if (result.findings.empty())
    throw InputError(fmt::format("{}: {} measures nothing of what it limits", budget.file,
                                 run.facts.measured ? run.name : baseline->name));
  add_bad_verdicts(result, run, budget);
  for (Finding& finding : result.findings)
    for (const AcceptedMiss& miss : budget.accepted)
      if (!finding.met && finding.title() == miss.limit) accept(finding, miss, budget);
  if (result.missed() + result.warned() > 0)
    explain(result, run, baseline != nullptr ? baseline : beside);
  return result;
}

}  // namespace leviosim::tools
