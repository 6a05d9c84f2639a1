#include "tools/app/html_report/report_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "sim/base/check.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/comparison/comparison_files.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/run_data.h"

namespace leviosim::tools {

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
