// A study is a value: its name, what it leaves, and the function that answers it. How it begins and
// ends is the same for all: files are claimed before work is done, the answer goes to people, to
// files, to --json and to the page, and decides the exit status. What a study finds is its own.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/outputs/output_folder.h"
#include "tools/app/budget/check.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/run/run_options.h"
#include "tools/app/study/runner.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {

struct StudyFile {
  std::string name;
  std::string text;
};

/// What came out of a study.
struct Answer {
  std::vector<std::string> parts{};  ///< for people, as of a screen
  std::string conclusion{};          ///< Printout::ending()
  std::vector<std::string> next{};
  Table rows{{}};              ///< for --csv, --json and the page
  Json more = Json::object();  ///< of the document, besides the rows
  StudyPage page{};            ///< rows and, where it has none, title and summary are filled in
  bool is_met = true;          ///< else the exit status is 1
  bool is_list = false;        ///< of what would be done: printed whole, and nothing is left
  std::function<CheckResult()> check{};  ///< against the budget that was given; owns what it needs

  /// Of the folder: what the answer depends on, which manifest.json says with the command line; and
  /// its other files.
  Json manifest = Json::object();
  std::vector<StudyFile> files{};
  std::function<void(outputs::OutputFolder&)> write_more{};  ///< files that are large
};

/// RunOptions::out is --csv or --out.
struct StudyOptions : RunOptions {
  std::string report;
  RunnerArguments runner;
};

struct Study {
  enum class Leaves { table, folder };  ///< --csv FILE, --out DIR

  const char* name;  ///< of the command, of documents
  const char* line;  ///< in the list of commands
  const char* noun;  ///< what a point is called
  std::vector<std::string> examples;
  Leaves leaves = Leaves::table;  ///< a folder comes with --cache: outcomes of points are kept
};

/// The command without options.
CLI::App* add_study_command(CLI::App& app, const Study& study);
/// What all studies declare: --csv or --out, --report, --force, --jobs, --cache, --json.
void add_study_options(CLI::App& command, const Study& study, StudyOptions& options);

/// Claims the files, asks, and publishes the answer.
/// @param inputs        that stay as they are
/// @param command_line  for the manifest
/// @throws InputError, Interrupted, LimitNotMet
void run_study(const Study& study, const StudyOptions& options,
               std::vector<std::filesystem::path> inputs, const Arguments& command_line,
               const std::function<Answer(const RunnerOptions&)>& answer);

/// A study as a command. @param declare  its options besides
/// @param inputs   as of run_study(); checks what can be checked without work
/// @param answer   computes it
template <class Options>
Command add_study(CLI::App& app, const Arguments& words, const Study& study,
                  void (*declare)(CLI::App&, Options&),
                  std::vector<std::filesystem::path> (*inputs)(const Options&),
                  Answer (*answer)(const Options&, const RunnerOptions&, const Arguments&)) {
  CLI::App* command = add_study_command(app, study);
  const auto options = std::make_shared<Options>();
  declare(*command, *options);
  add_study_options(*command, study, *options);
  return {.app = command,
          .run =
              [=, &words] {
                run_study(
                    study, *options, inputs(*options), words,
                    [&](const RunnerOptions& runner) { return answer(*options, runner, words); });
              },
          .goes_on = study.leaves == Study::Leaves::folder};
}

}  // namespace leviosim::tools
