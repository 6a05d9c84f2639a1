// The least L1 or L2 in which the work of a request fits: what a user asks for whom a smaller one
// refuses.
#pragma once

#include <optional>
#include <string>

#include "sim/work/arena.h"
#include "tools/app/run/run_request.h"

namespace leviosim::tools {

/// In whole KiB, by the same plans as a run: the work is done natively in ever larger memories,
/// each larger by what was missing in the one before, until all frames pass; then in smaller ones
/// again, down to the last in which they do.
/// @param from  that is too small
/// @return nothing where no size up to 16 MiB works, and of workloads that are not the odometry
std::optional<Bytes> least_l1(const RunRequest& request, Bytes from);
/// The same of L2, beside the chip's own L1 and external memory.
std::optional<Bytes> least_l2(const RunRequest& request, Bytes from);

/// How to have more of the memory that overflowed: "workload.l1=18KiB is the least in which a
/// native run works".
std::string larger_memory(const RunRequest& request, const work::MemoryOverflow& overflow);

}  // namespace leviosim::tools
