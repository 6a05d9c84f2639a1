// What every command that runs the workload does around the run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/outputs/output_place.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/progress_line.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/manifest.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_source.h"

namespace leviosim::tools {

/// What --out and --force ask for, or another option that RunOptions::out keeps; what the run reads
/// stays as it is.
outputs::OutputRequest out_request(const RunOptions& options, const char* option = "--out");

/// The folders that --data names: the recording, and the one in it that may be a link.
std::vector<std::filesystem::path> data_inputs(const std::string& data);

/// Estimate, on the high side, of the size of the results of a run with all frames [bytes].
std::uint64_t expected_bytes(const RunRequest& request, bool record);

/// The folder that --data names; makes the synthetic flight if it is asked for and not there yet.
std::string data_folder(const RunOptions& options, ProgressLine::Style progress);

/// Shows the frames on the line, which outlives it. @throws Interrupted if the user asked to stop
ProgressCallback shown_on(ProgressLine& line);

/// @throws Interrupted between two frames if the user asked to stop
RunResult simulate_with_progress(const RunRequest& request, ProgressLine::Style style);

/// The same with the work of another workload than LEVIO, on the chip of the request.
RunResult simulate_with_progress(const RunRequest& request, RunSource& source,
                                 ProgressLine::Style style);

/// What was computed over which data, with digests of it. The chip and the command line are left to
/// the caller.
Manifest manifest_of_data(const RunRequest& request);

Manifest make_manifest(const RunOptions& options, const RunRequest& request,
                       const Arguments& words);

/// Ends the file of what a run recorded with what the run knows about itself beyond its work.
/// @returns its bytes, if the recording holds them
std::string work_trace_of(WorkRecording recording, const RunOptions& options,
                          const RunRequest& request, const Manifest& manifest);

/// What a replay is timed on: the chip that the options name, or that of the recording with what
/// they set.
/// @throws InputError for unknown chips, and for parameters of the workload
RunRequest replay_request(const traces::WorkTrace& trace, const RunOptions& options);

/// @param digest   of the trace
/// @param options  with the name of the chip
Manifest replay_manifest(const traces::WorkTrace& trace, const InputDigest& digest,
                         const RunOptions& options, const Arguments& words);

/// "leviosim 0.1.0: levio on gap9, 300 frames of DIR, 160x120, 8 cores at 370 MHz, …"
std::string heading(const RunOptions& options, const RunResult& run);

}  // namespace leviosim::tools
