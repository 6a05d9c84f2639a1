#include "tools/app/study/study.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <utility>

#include "tools/app/budget/gate.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/report_option.h"

namespace leviosim::tools {
namespace {

/// Where an answer goes, besides the screen.
struct Places {
  std::optional<outputs::OutputFile> page;
  std::optional<outputs::OutputFile> csv;
  std::optional<outputs::OutputFolder> folder;
};

void claim(const Study& study, const StudyOptions& options,
           const std::vector<std::filesystem::path>& inputs, Places& places) {
  places.page = claimed_report(options.report, options.force, inputs);
  if (study.leaves == Study::Leaves::table) {
    places.csv = claimed_file(
        {.option = "--csv", .path = options.out, .replace = options.force, .inputs = inputs});
    expect_different(places.csv, "--csv", places.page, "--report");
  } else if (!options.out.empty()) {
    places.folder.emplace(outputs::OutputRequest{
        .option = "--out", .path = options.out, .replace = options.force, .inputs = inputs});
  }
}

std::string page_of(const Study& study, Answer& found) {
  StudyPage& page = found.page;
  if (page.title.empty()) page.title = study.line;
  if (page.boxes.empty() || page.summary.empty())
    page.summary = found.conclusion + (page.summary.empty() ? "" : '\n' + page.summary);
  if (page.points.heads().empty()) page.points = found.rows;
  return html_page(study_report(page));
}

/// The content of manifest.json. Nothing in it depends on the host or on what was in caches.
std::string manifest_of(const Study& study, const Answer& found, const Arguments& command_line) {
  Json document;
  document["format"] = fmt::format("leviosim {} manifest", study.name);
  document["version"] = 1;
  document["program"]["version"] = version();
  document["program"]["revision"] = revision();
  document["program"]["estimator"] = results_version();
  document["command_line"] = command_line;
  document.update(found.manifest);
  return json_text(document, 2) + '\n';
}

void publish_answer(const Study& study, const Answer& found, const std::string& page_text,
                    const Printout& shown, const Arguments& command_line, Places& places) {
  const FileOutput page{places.page, page_text, "report"};
  if (!places.folder) {
    publish({{places.csv, places.csv ? csv_text(found.rows) : "", "table"}, page}, shown);
    return;
  }
  outputs::OutputFolder& out = *places.folder;
  publish(out, shown, [&] {
    for (const StudyFile& file : found.files) out.write(file.name, file.text);
    if (found.write_more) found.write_more(out);
    out.write("manifest.json", manifest_of(study, found, command_line));
  });
  publish({page}, Printout(std::string(), shown.is_whole));
}

}  // namespace

CLI::App* add_study_command(CLI::App& app, const Study& study) {
  return app.add_subcommand(study.name, study.line);
}

void add_study_options(CLI::App& command, const Study& study, StudyOptions& options) {
  if (study.leaves == Study::Leaves::table) {
    TextOptions{command}("--csv", options.out, "FILE", "write the rows to a file");
    command.add_flag("--force", options.force, "replace these files");
    add_jobs_option(command, options.runner.jobs, study.noun);
  } else {
    TextOptions{command}("--out", options.out, "DIR",
                         "folder for the results; must be new or empty");
    command.add_flag("--force", options.force, "replace earlier results");
    add_runner_options(command, options.runner, study.noun);
  }
  add_report_option(command, options.report);
  add_examples(command, study.examples);
  add_json_option(command, options.json);
}

void run_study(const Study& study, const StudyOptions& options,
               std::vector<std::filesystem::path> inputs, const Arguments& command_line,
               const std::function<Answer(const RunnerOptions&)>& answer) {
  const RunnerOptions runner = runner_options(options.runner, study.noun, options.quiet);
  Places places;
  claim(study, options, inputs, places);
  Answer found = answer(runner);
  if (found.is_list) {
    for (const std::string& part : found.parts) print(Printout(part, true));
    return;
  }
  const std::string page = places.page ? page_of(study, found) : std::string();
  const Printout shown = printout(
      options.json, [&] { return Printout(found.parts).ending(found.conclusion, found.next); },
      [&] { return table_document(study.name, found.rows, found.more); });
  publish_answer(study, found, page, shown, command_line, places);
  if (found.check) print_check(found.check());
  if (!found.is_met) throw LimitNotMet();
}

}  // namespace leviosim::tools
