// The runs that a command line names: folders of runs, or recorded work that is replayed on a chip.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/app/comparison/run_record.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/run/run_request.h"
#include "traces/work_traces/work_trace.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// The chip on which traces are replayed, and what a trace may take of memory.
struct RecordOptions : RunOptions {
  std::string memory;

  bool names_chip() const { return !platform.empty() || !overrides.empty() || !cores.empty(); }
};

/// Declares --platform, -p, --cores, --max-memory and --quiet.
void add_record_options(CLI::App& command, RecordOptions& options);

/// The trace that a file is, or that a folder holds; else empty.
std::string trace_of(const std::string& name);

/// Of a folder what lies in it, unless the options name a chip; then, and of a trace, what a replay
/// yields, on the chip of the recording if none is named. Of a CSV file what was measured.
/// @param files  gets what a run folder holds, or would; may be null
/// @throws InputError for what is neither, and as replay()
RunRecord read_record(const std::string& name, const RecordOptions& options,
                      RunFiles* files = nullptr);

/// Runs or replays a request, and tells how far it is.
using Compute = std::function<RunResult(const RunRequest&, const ProgressCallback&)>;

/// The record of what `compute` yields, whose cycles are watched meanwhile.
/// @throws InputError as it does, Interrupted
RunRecord computed_record(const std::string& name, RunRequest request, const Manifest& manifest,
                          const Compute& compute, bool quiet, RunFiles* files = nullptr);

/// What a manifest of a replay says of the recorded run; the chip is left to the caller.
Manifest manifest_of_recording(const traces::WorkTrace& trace);

/// The replay of a trace, with `overrides` of the chip of the recording or of options.platform.
RunRecord replay_record(const std::string& trace, const RecordOptions& options,
                        RunFiles* files = nullptr);

// Frames and positions as the files of a run folder have them.

/// The rows of frames.csv; those of a native run have no times.
/// @throws InputError for a table that cannot be read
std::vector<RecordedFrame> read_frames(const std::filesystem::path& file, const std::string& csv);

/// The rows of errors.csv. @throws InputError for a table that cannot be read
std::vector<PositionPair> read_positions(const std::filesystem::path& file, const std::string& csv);

}  // namespace leviosim::tools
