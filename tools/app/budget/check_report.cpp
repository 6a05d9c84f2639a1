#include "tools/app/budget/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/sha256.h"
#include "sim/base/text.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/figures.h"
#include "tools/app/comparison/comparison.h"
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
  if (!f.value || !f.bound) return "–";
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

std::string xml(const std::string& raw) { return escape_markup(printable(raw)); }

std::string test_case(const Finding& f) {
  const std::string head = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"0\"",
                                       xml(f.section->name), xml(f.title()));
  if (!f.fails())
    return f.met ? head + "/>\n"
                 : fmt::format("{}>\n      <system-out>warning: {}</system-out>\n    </testcase>\n",
                               head, xml(f.excess()));
  std::string body;
  body += xml(fmt::format("{}:{}", f.limit->file, f.limit->line)) + '\n';
  if (!f.where.empty()) body += "where: " + xml(f.where) + '\n';
  for (const std::string& reason : f.why) body += "why: " + xml(reason) + '\n';
  if (!f.limit->reason.empty()) body += "reason: " + xml(f.limit->reason) + '\n';
  if (!f.limit->owner.empty()) body += "owner: " + xml(f.limit->owner) + '\n';
  return fmt::format(
      "{}>\n      <failure type=\"limit\" message=\"{}\">{}</failure>\n"
      "    </testcase>\n",
      head, xml(f.excess()), body);
}

/// Findings stand in the order of the sections.
template <class F>
void for_each_section(const CheckResult& result, F&& f) {
  for (std::size_t begin = 0; begin < result.findings.size();) {
    std::size_t end = begin;
    std::size_t missed = 0;
    std::string cases;
    for (; end < result.findings.size() &&
           result.findings[end].section == result.findings[begin].section;
         ++end) {
      if (result.findings[end].fails()) ++missed;
      cases += test_case(result.findings[end]);
    }
    f(*result.findings[begin].section, end - begin, missed, cases);
    begin = end;
  }
}

/// All of it in one text.
std::string message(const Finding& f) {
  std::string text = f.excess();
  if (!f.where.empty()) text += ". Where: " + f.where;
  if (!f.why.empty()) text += fmt::format(". Why: {}", fmt::join(f.why, "; "));
  if (!f.limit->reason.empty()) text += ". Reason of the limit: " + f.limit->reason;
  if (!f.limit->owner.empty()) text += ". Owner: " + f.limit->owner;
  return printable(text);
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

std::string junit_xml(const CheckResult& result) {
  std::string suites;
  for_each_section(result, [&](const BudgetSection& section, std::size_t tests, std::size_t missed,
                               const std::string& cases) {
    suites += fmt::format(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"0\" "
        "time=\"0\">\n{}  </testsuite>\n",
        xml(section.name), tests, missed, cases);
  });
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuites name=\"leviosim check\" tests=\"{}\" failures=\"{}\" errors=\"0\" "
      "time=\"0\">\n{}</testsuites>\n",
      result.findings.size(), result.missed(), suites);
}

std::string markdown_comment(const CheckResult& result, const RunRecord& run,
                             const RunRecord* baseline) {
  std::string text =
      fmt::format("### leviosim: {}\n\n",
                  result.missed() == 0
                      ? result.warned() == 0 ? "all limits are met" : "met, with warnings"
                      : fmt::format("{} of {} limits {} not met", result.missed(),
                                    result.findings.size(), result.missed() == 1 ? "is" : "are"));
  for (const RunVerdict& verdict : run.verdicts.list)
    text +=
        fmt::format("- **{}**: {}{}\n", verdict.about, markdown_text(std::string(verdict.word())),
                    verdict.reason().empty() ? "" : ": " + markdown_text(verdict.reason()));
  for (const Finding& f : result.findings) {
    if (f.met) continue;
    text += fmt::format("\n**{} {}**: {}\n", f.fails() ? "✗" : "⚠", markdown_text(f.title()),
                        markdown_text(f.excess()));
    if (!f.where.empty()) text += fmt::format("- where: {}\n", markdown_text(f.where));
    for (const std::string& why : f.why) text += fmt::format("- why: {}\n", markdown_text(why));
    if (!f.limit->owner.empty())
      text += fmt::format("- owner: {}\n", markdown_text(f.limit->owner));
  }
  for (const Finding& f : result.findings)
    if (f.better())
      text += fmt::format("\n**✓ {}**: {}, {:.2f} % better than the baseline\n",
                          markdown_text(f.title()), figure_text(*f.value, f.unit, f.limit->bound),
                          *f.better());
  if (result.better() > 0 && result.is_kept)
    text += "\nThe baseline is stale: its limits allow these figures to worsen again.\n";
  if (baseline != nullptr)
    text += fmt::format("\n<details><summary>What changed since {}</summary>\n\n{}\n</details>\n",
                        markdown_text(baseline->name),
                        comparison_report(compare_runs(*baseline, run), ReportFormat::markdown));
  Table table({{"", kLeft}, {"limit", kLeft}, {"found"}, {"bound"}});
  for (const Finding& f : result.findings)
    table.add({f.met       ? "met"
               : f.fails() ? "✗ not met"
                           : "warning",
               f.title(), f.value ? figure_text(*f.value, f.unit, f.limit->bound) : "–",
               f.bound ? figure_text(*f.bound, f.unit, f.limit->bound) : "–"});
  return text + fmt::format("\n<details><summary>All {} limits</summary>\n\n{}\n</details>\n",
                            result.findings.size(), markdown_table(table));
}

std::string github_annotations(const CheckResult& result) {
  const auto escaped = [](const std::string& text, bool property) {
    std::string out;
    for (const char c : text) {
      const bool special =
          c == '%' || c == '\r' || c == '\n' || (property && (c == ':' || c == ','));
      out += special ? fmt::format("%{:02X}", static_cast<unsigned char>(c)) : std::string(1, c);
    }
    return out;
  };
  std::string text;
  for (const Finding& f : result.findings)
    if (!f.met)
      text += fmt::format("::{} file={},line={},title={}::{}\n", f.fails() ? "error" : "warning",
                          escaped(printable(f.limit->file), true), f.limit->line,
                          escaped(printable(f.title()), true), escaped(message(f), false));
  return text;
}

std::string gitlab_report(const CheckResult& result) {
  Json list = Json::array();
  for (const Finding& f : result.findings) {
    if (f.met) continue;
    Json& entry = list.emplace_back(Json::object());
    std::string description = f.title() + ": " + f.excess();
    if (!f.where.empty()) description += "; " + f.where;
    for (const std::string& reason : f.why) description += "; " + reason;
    entry["description"] = printable(description);
    entry["check_name"] = "leviosim budget";
    // Of the limit, not of what was found: the same fault of two commits is the same one.
    entry["fingerprint"] = base::sha256_of(f.section->name + '\n' + f.title());
    entry["severity"] = f.fails() ? "major" : "info";
    entry["location"]["path"] = f.limit->file;
    entry["location"]["lines"]["begin"] = f.limit->line;
  }
  return json_text(list, 2) + '\n';
}

}  // namespace leviosim::tools
