#include "tools/app/study/study.h"

#include <CLI/CLI.hpp>

#include <utility>

#include "sim/outputs/output_folder.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/html_report/study_page.h"

namespace leviosim::tools {
namespace {

Json page_of(const Study& study, Answer& found) {
  StudyPage& page = found.page;
  if (page.title.empty()) page.title = study.line;
  if (page.summary.empty()) page.summary = found.conclusion;
  if (page.points.heads().empty()) page.points = found.rows;
  return study_report(page);
}

}  // namespace

CLI::App* add_study_command(CLI::App& app, const Study& study) {
  return app.add_subcommand(study.name, study.line);
}

void add_study_options(CLI::App& command, const Study& study, StudyOptions& options) {
  TextOptions{command}("--csv", options.out, "FILE", "write the rows to a file");
  add_report_option(command, options.report);
  command.add_flag("--force", options.force, "replace these files");
  add_jobs_option(command, options.jobs, study.noun);
  add_examples(command, study.examples);
  add_json_option(command, options.json);
}

void run_study(const Study& study, const StudyOptions& options,
               std::vector<std::filesystem::path> inputs,
               const std::function<Answer(const RunnerOptions&)>& answer) {
  const RunnerOptions runner{.noun = study.noun,
                             .threads = parse_jobs(options.jobs),
                             .progress = ProgressLine::style_of_stderr(options.quiet)};
  std::optional<outputs::OutputFile> csv = claimed_file(
      {.option = "--csv", .path = options.out, .replace = options.force, .inputs = inputs});
  std::optional<outputs::OutputFile> page =
      claimed_report(options.report, options.force, std::move(inputs));
  expect_different(csv, "--csv", page, "--report");
  Answer found = answer(runner);
  const std::string html = page ? html_page(page_of(study, found)) : std::string();
  publish(
      {{csv, csv_text(found.rows), "table"}, {page, html, "report"}},
      printout(
          options.json, [&] { return Printout(found.parts).ending(found.conclusion, found.next); },
          [&] { return table_document(study.name, found.rows, found.more); }));
  if (!found.is_met) throw LimitNotMet();
}

}  // namespace leviosim::tools
