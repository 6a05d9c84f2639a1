// What a work trace holds, for people.
#pragma once

#include <string>

#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// Reads all frames. @throws InputError for what cannot be replayed
std::string trace_summary(const traces::WorkTrace& trace);

}  // namespace leviosim::tools
