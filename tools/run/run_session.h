// What every command that runs the workload does around the run.
#pragma once

#include <filesystem>

#include "tools/cli/command_line.h"
#include "tools/cli/progress_line.h"
#include "tools/run/job_source.h"
#include "tools/run/manifest.h"
#include "tools/run/run_options.h"

namespace leviosim::tools {

/// The absolute path of --out. Results replace nothing but results: a mistyped --out --force must
/// not cost anybody's files.
/// @throws InputError if it is a file, or a folder with something else than results, or with
///         results and without --force
std::filesystem::path checked_out_folder(const std::string& out, bool force);

/// The same for commands whose --out is one file: as cli/command_line.h says. Before the run, so
/// that nobody waits for a file that cannot be written.
void check_out_file(const RunOptions& options);

/// The folder that --data names; makes the synthetic flight if it is asked for and not there yet.
std::string data_folder(const RunOptions& options, ProgressLine::Style progress);

/// @throws Interrupted between two frames if the user asked to stop
RunResult simulate_with_progress(const RunRequest& request, ProgressLine::Style style);

/// The same with the work of another workload than LEVIO, on the chip of the request.
RunResult simulate_with_progress(const RunRequest& request, JobSource& source,
                                 ProgressLine::Style style);

Manifest make_manifest(const RunOptions& options, const RunRequest& request, const Words& words);

/// "leviosim 0.1.0: levio on gap9, 300 frames of DIR, 160x120, 8 cores at 370 MHz, …"
std::string heading(const RunOptions& options, const RunResult& run);

}  // namespace leviosim::tools
