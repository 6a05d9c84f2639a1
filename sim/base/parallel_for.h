// Runs independent jobs on several threads. Which thread runs which job is left to chance, so jobs
// must not depend on it.
#pragma once

#include <cstddef>
#include <functional>

namespace leviosim::base {

/// Calls job(0) ... job(count - 1) on `threads` threads (0: as many as the host has) and returns
/// when all are done. The first exception stops the hand-out of jobs and is thrown again here, and
/// so does Interrupted (sim/base/interruption.h), which is asked for before every job.
void parallel_for(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& job);

}  // namespace leviosim::base
