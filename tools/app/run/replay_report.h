// What `leviosim replay` says beyond what a run says: in which frames the recorded algorithm would
// have seen something else on this chip.
#pragma once

#include <string>

#include "tools/app/report/statistics.h"
#include "tools/app/run/trace_source.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// Sums, and the first frames that differ.
std::string replay_report(const Replay& replay, const traces::WorkTrace& trace);

/// A row per frame: how it began in the recording and now.
std::string replay_csv(const Replay& replay);

/// For the manifest: what was recorded, and the digest of the trace.
Json recording_json(const traces::WorkTrace& trace, const std::string& sha256);

// What a work trace holds, for people.

/// Reads all frames. @throws InputError for what cannot be replayed
std::string trace_summary(const traces::WorkTrace& trace);

}  // namespace leviosim::tools
