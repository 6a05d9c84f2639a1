// What `leviosim replay` says beyond what a run says: in which frames the recorded algorithm would
// have seen something else on this chip.
#pragma once

#include <string>

#include "tools/app/run/replay.h"
#include "tools/app/table/json.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// Sums, and the first frames that differ.
std::string replay_report(const Replay& replay, const traces::WorkTrace& trace);

/// A row per frame: how it began in the recording and now.
std::string replay_csv(const Replay& replay);

/// For the manifest: what was recorded, and the digest of the trace.
Json recording_json(const traces::WorkTrace& trace, const std::string& sha256);

}  // namespace leviosim::tools
