#include "tools/app/budget/check_for_ci.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "sim/base/printable.h"
#include "sim/base/sha256.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/figures.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_report.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

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
  std::map<std::string, std::string> explained;  // reasons → the first limit with them
  for (const Finding& f : result.findings) {
    if (f.met) continue;
    text += fmt::format("\n**{} {}**: {}\n", f.fails() ? "✗" : "⚠", markdown_text(f.title()),
                        markdown_text(f.excess()));
    if (!f.where.empty()) text += fmt::format("- where: {}\n", markdown_text(f.where));
    const std::string reasons = fmt::format("{}", fmt::join(f.why, "\n"));
    const auto [first, is_new] = explained.try_emplace(reasons, f.title());
    if (is_new)
      for (const std::string& why : f.why) text += fmt::format("- why: {}\n", markdown_text(why));
    else if (!f.why.empty())
      text += fmt::format("- why: as for {}\n", markdown_text(first->second));
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
