// A recorded run on another chip: the same work, timed anew in the same loop of camera, front end
// and optimiser.
#pragma once

#include <string>

#include "tools/app/run/run_request.h"
#include "tools/app/run/trace_source.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

struct Replay {
  RunResult run;  ///< names of blocks in it are the trace's
  std::vector<FrameComparison> frames;
  Bytes recorded_l1;  ///< size of L1 on the chip of the recording
};

/// The shipped chip with the values of the recording's platform, which names the instruction set
/// that it builds on; empty if there is none.
std::string shipped_chip(const traces::WorkTrace& trace);

/// The platform that the trace was recorded on, with what was overridden then. Where an override
/// names another instruction set, that of shipped_chip() if there is one.
platform::ResolvedPlatform recorded_platform(const traces::WorkTrace& trace,
                                             const std::vector<std::string>& overrides = {});

/// @throws InputError for another number of cores than the work was divided among
void check_cores(const traces::WorkTrace& trace, const RunRequest& request);

/// @param request  gives platform, cores and observer; the rest is the trace's
/// @throws InputError if the work does not fit the chip: another number of cores than it was
/// divided
///         among, too little memory
Replay replay(const traces::WorkTrace& trace, const RunRequest& request,
              const ProgressCallback& progress);

}  // namespace leviosim::tools
