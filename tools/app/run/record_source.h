// The runs that a command line names: folders of runs, or recorded work that is replayed on a chip.
#pragma once

#include <functional>
#include <string>

#include "tools/app/record/record.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "traces/work_traces/work_trace.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// The chip on which traces are replayed, and the memory that a trace may take.
struct RecordOptions : RunOptions {
  std::string memory;

  bool names_chip() const { return !platform.empty() || !overrides.empty() || !cores.empty(); }
};

/// Declares --platform, -p, --cores, --max-memory and --quiet.
void add_record_options(CLI::App& command, RecordOptions& options);

/// The trace that a file is, or that a folder holds; else empty.
std::string trace_of(const std::string& name);

/// The run that a name stands for: of a folder, the run that lies there, unless the options name a
/// chip; then, and of a trace, its replay, on the chip of the recording if none is named; of a CSV
/// file, the measurement. @param with_tables  false: only the record is read
/// @throws InputError for other files, and as replay()
RunFolder read_run(const std::string& name, const RecordOptions& options, bool with_tables);
/// The record alone.
RunRecord read_record(const std::string& name, const RecordOptions& options);

/// Runs or replays a request, and reports progress.
using Compute = std::function<RunResult(const RunRequest&, const ProgressCallback&)>;

/// The content of the run folder that `compute` would leave.
/// @throws InputError as it does, Interrupted
RunFolder computed_run(const std::string& name, const RunRequest& request, const Manifest& manifest,
                       const Compute& compute, bool quiet);

/// What a manifest of a replay says of the recorded run; the chip is left to the caller.
Manifest manifest_of_recording(const traces::WorkTrace& trace);

/// The replay of a trace, with `overrides` of the chip of the recording or of options.platform.
RunFolder replayed_run(const std::string& trace, const RecordOptions& options);

}  // namespace leviosim::tools
