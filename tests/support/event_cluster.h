// A cluster in the event kernel: every core, the DMA and the solver of contention are processes,
// and a share ends when a timer says so. A reference for sim/chip/cluster.h, which walks from step
// to step instead: both must book the same cycles, bit by bit.
//
// Left out: accounts by fork and operation, and steps.
#pragma once

#include "sim/chip/config.h"
#include "sim/chip/timing.h"
#include "sim/work/program.h"

namespace leviosim::testing {

/// Times a job that begins at 0. @param workers  of the team, 1 at least
sim::JobTiming time_in_event_kernel(const sim::ClusterConfig& config, int workers,
                                    const work::Job& job);

}  // namespace leviosim::testing
