// Runs a source of work on the chip of a request and puts together what the run produced.
#pragma once

#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_source.h"

namespace leviosim::tools {

/// The workload of the request over its data, on its chip or natively.
/// @throws InputError for data or requests that cannot be run
RunResult simulate(const RunRequest& request, const ProgressCallback& progress);

/// The work of any source on the chip of the request; the rest of the request is the source's.
/// @throws InputError for a chip that cannot run it
RunResult simulate_source(const RunRequest& request, RunSource& source,
                          const ProgressCallback& progress);

}  // namespace leviosim::tools
