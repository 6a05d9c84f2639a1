// The option --report of commands: claims the file before work is done, writes the page at the end.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/outputs/output_file.h"
#include "tools/app/budget/gate.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/run/run_folder.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// Declares --report FILE.
void add_report_option(CLI::App& command, std::string& file);

/// None if no file is named. @param inputs  that stay as they are
/// @throws InputError if it cannot be written
std::optional<outputs::OutputFile> claimed_report(const std::string& file, bool replace,
                                                  std::vector<std::filesystem::path> inputs = {},
                                                  const std::string& option = "--report");

/// The data of a page about runs. The others are compared with the first.
/// @param check  may be null
Json runs_report(const std::vector<RunFolder>& runs, const std::vector<RunComparison>& comparisons,
                 const CheckResult* check);

/// How commands that run or replay end: with the page, and what a budget says, if they are asked
/// for.
/// @throws LimitNotMet if a limit is not met
void report_and_check(const RunFolder& run, std::optional<outputs::OutputFile>& page,
                      const std::optional<Gate>& gate, bool say = true);

/// Writes the page, if there is a file for it.
/// @param say  whether to print where it is
void publish_report(std::optional<outputs::OutputFile>& file, const Json& data, bool say = true);

}  // namespace leviosim::tools
