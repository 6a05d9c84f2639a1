// The printout of commands that run a workload: the summary, the tables that --tables names, or
// with
// --json the record.
#pragma once

#include <string>

#include "tools/app/cli/printout.h"
#include "tools/app/record/record.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_options.h"

namespace leviosim::tools {

/// Declares --tables and --json.
void add_print_options(CLI::App& command, RunOptions& options);

/// @param budget  that the command checks, whose outcome is text; empty if there is none
/// @throws InputError for tables that there are not, and for text and JSON at once
void check_print_options(const RunOptions& options, const std::string& budget);

/// @param remarks  that stand between heading and tables
Printout run_printout(const RunOptions& options, const RunResult& run, const RunRecord& record,
                      const std::string& remarks = {});

}  // namespace leviosim::tools
