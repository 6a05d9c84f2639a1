#include "tools/app/budget/check_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "sim/base/printable_text.h"
#include "tools/app/budget/figures.h"
#include "tools/app/comparison/comparison_report.h"
#include "tools/app/report/number_text.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

constexpr int kWidth = 80;
constexpr int kIndent = 9;
constexpr int kWidest = 44;  // limit in the table

std::string wrapped(const std::string& label, const std::string& raw) {
  if (raw.empty()) return {};
  const std::string words = printable(raw);
  std::vector<std::string> items{label};
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(' ', begin), words.size());
    items.push_back(words.substr(begin, end - begin));
    begin = end + 1;
  }
  return std::string(kIndent, ' ') + wrap(items, " ", kIndent, kWidth) + '\n';
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
  return f.limit->line == 0 ? f.limit->file
                            : fmt::format("{}:{}", f.limit->file, f.limit->line);
}

}  // namespace

std::string check_text(const CheckResult& result) {
  const std::size_t limits = result.findings.size();
  const std::string count = fmt::format("{} limit{}", limits, limits == 1 ? "" : "s");
  std::string text = fmt::format("{} against {}: {}, {} not met\n", printable(result.run),
                                 printable(result.budget), count, result.missed());
  if (!result.baseline.empty()) text += fmt::format("baseline: {}\n", printable(result.baseline));
  TextTable table({{"", kLeft}, {"limit", kLeft, 1}, {"found"}, {"margin"}});
  for (const Finding& f : result.findings)
    table.add({f.met ? "met" : "NOT MET", shortened(f.title(), kWidest),
               f.value ? figure_text(*f.value, f.unit, f.limit->bound) : "–", margin(f)});
  text += table.str();
  for (const Finding& f : result.findings)
    if (!f.met)
      text += fmt::format("\nNOT MET  {}: {}\n", printable(place(f)), printable(f.title())) +
              details(f);
  return text;
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
