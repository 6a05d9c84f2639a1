// A study is a value: its name, its options, and what answers them. How it begins and ends is the
// same for all: files are claimed before work is done, the answer goes to people, to --csv, --json
// and --report, and decides the exit status. What a study finds is its own.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/run/run_options.h"
#include "tools/app/study/runner.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {

/// What came out of a study.
struct Answer {
  std::vector<std::string> parts;  ///< for people, as of a screen
  std::string conclusion;          ///< Printout::ending()
  std::vector<std::string> next;
  Table rows{{}};              ///< for --csv, --json and the page
  Json more = Json::object();  ///< of the document, besides the rows
  StudyPage page{};            ///< rows and, where it has none, title and summary are filled in
  bool is_met = true;          ///< else the exit status is 1
};

/// RunOptions::out is --csv.
struct StudyOptions : RunOptions {
  std::string report;
  std::string jobs;
};

struct Study {
  const char* name;  ///< of the command, of the document
  const char* line;  ///< in the list of commands
  const char* noun;  ///< what a point is called
  std::vector<std::string> examples;
};

/// The command without options.
CLI::App* add_study_command(CLI::App& app, const Study& study);
/// What all studies declare: --csv, --report, --force, --jobs, --json.
void add_study_options(CLI::App& command, const Study& study, StudyOptions& options);

/// Claims the files, asks, and publishes the answer.
/// @param inputs  that stay as they are
/// @throws InputError, Interrupted, LimitNotMet
void run_study(const Study& study, const StudyOptions& options,
               std::vector<std::filesystem::path> inputs,
               const std::function<Answer(const RunnerOptions&)>& answer);

/// A study as a command. @param declare  its options besides
/// @param inputs   as of run_study()
/// @param answer   computes it
template <class Options>
Command add_study(CLI::App& app, const Words& words, const Study& study,
                  void (*declare)(CLI::App&, Options&),
                  std::vector<std::filesystem::path> (*inputs)(const Options&),
                  Answer (*answer)(const Options&, const RunnerOptions&, const Words&)) {
  CLI::App* command = add_study_command(app, study);
  const auto options = std::make_shared<Options>();
  declare(*command, *options);
  add_study_options(*command, study, *options);
  return {command, [=, &words] {
            run_study(study, *options, inputs(*options),
                      [&](const RunnerOptions& runner) { return answer(*options, runner, words); });
          }};
}

}  // namespace leviosim::tools
