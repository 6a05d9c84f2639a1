#include "tools/app/budget/check_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/printable.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/figures.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/result/verdict.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr int kCheckWidth = 80;
constexpr int kIndent = 9;
constexpr int kWidest = 44;  // limit in the table

std::string wrapped(const std::string& label, const std::string& raw) {
  if (raw.empty()) return {};
  return std::string(kIndent, ' ') +
         wrap_words(label + ' ' + printable(raw), kIndent, kCheckWidth) + '\n';
}

/// How much of a limit is left: of the bound, positive where it is met.
std::string margin(const Finding& f) {
  if (!f.value || !f.bound || !f.limit->bound.word.empty()) return "–";
  const double left = f.limit->bound.at_most ? *f.bound - *f.value : *f.value - *f.bound;
  if (*f.bound == 0) return left == 0 ? "0 %" : "–";
  return fmt::format("{:+.2f} %", 100 * left / std::abs(*f.bound));
}

std::string details(const Finding& f) {
  return wrapped("", f.excess()) + wrapped("where:", f.where) +
         wrapped("why:", fmt::format("{}", fmt::join(f.why, "; "))) +
         wrapped("reason:", f.limit->reason) + wrapped("owner:", f.limit->owner);
}

std::string place(const Finding& f) {
  return f.limit->line == 0 ? f.limit->file : fmt::format("{}:{}", f.limit->file, f.limit->line);
}

std::string table_of(const CheckResult& result) {
  const std::size_t limits = result.findings.size();
  const std::string count = fmt::format("{} limit{}", limits, limits == 1 ? "" : "s");
  std::string text = fmt::format("{} against {}: {}, {} not met", printable(result.run),
                                 printable(result.budget), count, result.missed());
  text += result.warned() == 0
              ? "\n"
              : fmt::format(", {} warning{}\n", result.warned(), result.warned() == 1 ? "" : "s");
  if (!result.baseline.empty()) text += fmt::format("baseline: {}\n", printable(result.baseline));
  if (!result.not_measured.empty())
    text += fmt::format("left out, since it was not measured: {}\n",
                        printable(fmt::format("{}", fmt::join(result.not_measured, ", "))));
  Table table({{"", kLeft}, {"limit", kLeft, 1}, {"found"}, {"margin"}});
  for (const Finding& f : result.findings)
    table.add({f.better()  ? "better"
               : f.met     ? "met"
               : f.fails() ? "NOT MET"
                           : "warning",
               shortened(f.title(), kWidest),
               f.value ? figure_text(*f.value, f.unit, f.limit->bound) : "–", margin(f)});
  return text + terminal_text(table);
}

std::string misses_of(const CheckResult& result) {
  std::string text;
  for (const Finding& f : result.findings)
    if (!f.met)
      text += fmt::format("\n{}  {}: {}\n", f.fails() ? "NOT MET" : "warning", printable(place(f)),
                          printable(f.title())) +
              details(f);
  return text;
}

/// "2 figures are better than base.json, most of all EPnP RANSAC: cycles <= +3 % (by 5.20 %)";
/// empty if none is.
std::string better_text(const CheckResult& result) {
  const Finding* best = nullptr;
  for (const Finding& f : result.findings)
    if (f.better() && (best == nullptr || *f.better() > *best->better())) best = &f;
  if (best == nullptr) return {};
  const std::size_t count = result.better();
  return fmt::format(
      "{} than {} by more than limits allow them to worsen: {}{} ({:.2f} %)",
      count == 1 ? "a figure is better" : fmt::format("{} figures are better", count),
      result.baseline, count == 1 ? "" : "most of all ", best->title(), *best->better());
}

/// The first that is not met, by how much and why.
std::string verdict_of(const CheckResult& result) {
  const std::size_t limits = result.findings.size();
  const auto missed = std::find_if(result.findings.begin(), result.findings.end(),
                                   [](const Finding& f) { return f.fails(); });
  if (missed == result.findings.end() && result.warned() > 0)
    return fmt::format("verdict: met: all {} limits of {}, but {} with a warning", limits,
                       result.budget, result.warned());
  if (missed == result.findings.end()) {
    const std::string better = better_text(result);
    return fmt::format("verdict: met: {} of {}{}{}",
                       limits == 1 ? "the limit" : fmt::format("all {} limits", limits),
                       result.budget, better.empty() ? "" : "; ", better);
  }
  std::string text =
      fmt::format("verdict: NOT met: {} of {} limits, {}{}: {}", result.missed(), limits,
                  result.missed() > 1 ? "first " : "", missed->title(), missed->excess());
  return missed->why.empty() ? text : text + "; " + missed->why.front();
}

}  // namespace

Printout check_printout(const CheckResult& result, std::vector<std::string> next) {
  if (result.missed() == 0 && result.better() > 0 && result.is_kept)
    next = {fmt::format("leviosim budget record {} --budget {} >BASELINE, which is stale",
                        shell_word(result.run), shell_word(result.budget))};
  else if (result.missed() == 0)
    next = {fmt::format("leviosim history add {} --budget {}", shell_word(result.run),
                        shell_word(result.budget))};
  return Printout({table_of(result), misses_of(result)})
      .ending(verdict_of(result), std::move(next));
}

Json check_json(const CheckResult& result) {
  Json json;
  json["format"] = "leviosim check";
  json["version"] = 1;
  json["run"] = result.run;
  json["budget"] = result.budget;
  if (!result.baseline.empty()) json["baseline"] = result.baseline;
  json["limits"] = result.findings.size();
  json["not_met"] = result.missed();
  json["warnings"] = result.warned();
  json["better"] = result.better();
  if (!result.not_measured.empty()) json["not_measured"] = result.not_measured;
  json["findings"] = Json::array();
  for (const Finding& f : result.findings) {
    Json& entry = json["findings"].emplace_back(Json::object());
    entry["section"] = f.section->name;
    entry["limit"] = f.limit->text;
    entry["line"] = f.limit->line;
    entry["statistic"] = f.statistic;
    if (!f.stage.empty()) entry["stage"] = f.stage;
    entry["unit"] = f.unit;
    entry["value"] = value_of(f.value);
    entry["bound"] = value_of(f.bound);
    if (f.baseline) entry["baseline"] = *f.baseline;
    if (!f.since.empty()) entry["since"] = f.since;
    if (!f.met) entry["level"] = f.fails() ? "fail" : "warn";
    if (f.better()) entry["better_percent"] = *f.better();
    if (f.was_over()) entry["was_over_before"] = true;
    const auto shown = [&](const std::optional<double>& v) {
      return v ? Json(figure_text(*v, f.unit, f.limit->bound)) : Json(nullptr);
    };
    entry["shown"] = {{"value", shown(f.value)}, {"bound", shown(f.bound)}};
    entry["met"] = f.met;
    if (!f.limit->reason.empty()) entry["reason"] = f.limit->reason;
    if (!f.limit->owner.empty()) entry["owner"] = f.limit->owner;
    if (f.met) continue;
    entry["excess"] = f.excess();
    entry["where"] = f.where;
    entry["why"] = f.why;
  }
  return json;
}

}  // namespace leviosim::tools
