#include "tools/app/html_report/page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "sim/base/check.h"
#include "tools/app/budget/check.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/terminal.h"

namespace leviosim::tools {
namespace {

std::string_view part(std::string_view name) {
  const auto parts = page_parts();
  const auto it = std::find_if(parts.begin(), parts.end(),
                               [&](const base::BuiltinFile& p) { return p.name == name; });
  check(it != parts.end(), "the page has all its parts");
  return it->text;
}

/// In the order in which they use each other.
std::string scripts() {
  std::string text;
  for (const char* name :
       {"dom", "table", "charting", "figures", "frames", "stages", "memory", "energy", "trajectory",
        "runs", "compare", "check", "study", "history", "main"})
    text += part(name);
  return text;
}

/// What the template has in place of a field such as "{{title}}".
std::string content(std::string_view field, const Json& data) {
  if (field == "title") return escape_markup(data.at("title").get<std::string>());
  if (field == "data") return script_json(data);
  if (field == "scripts") return scripts();
  if (field == "licence") return escape_markup(part("copyright"));
  return std::string(part(field));
}

}  // namespace

Json report_json(const std::string& title, Json runs) {
  Json data;
  data["format"] = "leviosim report";
  data["version"] = 1;
  data["title"] = title;
  data["runs"] = std::move(runs);
  return data;
}

std::string html_page(const Json& data) {
  std::string page;
  std::string_view rest = part("template");
  for (std::size_t begin = rest.find("{{"); begin != std::string_view::npos;
       begin = rest.find("{{")) {
    const std::size_t end = rest.find("}}", begin);
    page += rest.substr(0, begin);
    page += content(rest.substr(begin + 2, end - begin - 2), data);
    rest.remove_prefix(end + 2);
  }
  page += rest;
  return page;
}

std::string script_json(const Json& json) {
  const std::string plain = json_text(json);
  std::string text;
  text.reserve(plain.size());
  for (std::size_t from = 0; from < plain.size();) {
    const std::size_t at = std::min(plain.find('<', from), plain.size());
    text.append(plain, from, at - from);
    if (at < plain.size()) text += "\\u003c";
    from = at + 1;
  }
  return text;
}

void add_report_option(CLI::App& command, std::string& file) {
  TextOptions{command}("--report", file, "FILE.html",
                       "page to write, for a browser: one file, works offline");
}

std::optional<outputs::OutputFile> claimed_report(const std::string& file, bool replace,
                                                  std::vector<std::filesystem::path> inputs,
                                                  const std::string& option) {
  return claimed_file(
      {.option = option, .path = file, .replace = replace, .inputs = std::move(inputs)});
}

Json runs_report(const std::vector<RunFolder>& runs, const std::vector<RunComparison>& comparisons,
                 const CheckResult* check) {
  Json list = Json::array();
  for (const RunFolder& run : runs) list.push_back(run_json(run));
  std::vector<std::string> profiles;
  for (const RunFolder& run : runs)
    if (std::find(profiles.begin(), profiles.end(), run.record.facts.profile) == profiles.end())
      profiles.push_back(run.record.facts.profile);
  const std::string title =
      runs.size() == 1 ? fmt::format("{} on {}", runs.front().record.facts.profile,
                                     runs.front().record.facts.platform.empty()
                                         ? "the host"
                                         : runs.front().record.facts.platform)
                       : fmt::format("{} runs of {}", runs.size(), fmt::join(profiles, " and "));
  Json data = report_json(title, std::move(list));
  for (const RunComparison& comparison : comparisons)
    data["comparisons"].push_back(comparison_json(comparison));
  if (check != nullptr) data["check"] = check_json(*check);
  return data;
}

void report_and_check(const RunFolder& run, std::optional<outputs::OutputFile>& page,
                      const std::optional<Gate>& gate, bool say) {
  std::optional<CheckResult> check;
  if (gate) check = gate->check(run.record);
  if (page) publish_report(page, runs_report({run}, {}, check ? &*check : nullptr), say);
  if (check) print_check(*check);
}

void publish_report(std::optional<outputs::OutputFile>& file, const Json& data, bool say) {
  if (file) publish({{file, html_page(data), "report"}}, Printout(std::string(), !say));
}

}  // namespace leviosim::tools
