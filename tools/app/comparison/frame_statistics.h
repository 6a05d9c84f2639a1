// Statistics that need every frame or every memory, and so stand in no single line of stats.json:
// percentiles of the latency in open and closed loops, frames that missed their deadline, cycles of
// a mean frame, and the highest occupation of L1 and L2.
#pragma once

#include <filesystem>
#include <string>

#include "tools/app/comparison/run_record.h"

namespace leviosim::tools {

/// frame.latency.*, frame.missed_share and frame.cycles.* from the table of frames (frames.csv).
/// Nothing of a native run, which has no times. @returns the number of frames, with the dropped
/// @throws InputError for a table that is none, or that was cut off
std::int64_t add_frame_statistics(const std::filesystem::path& file, const std::string& frames_csv,
                                  RunRecord& record);

/// stages.*.operations: of all kinds.
void add_operations(RunRecord& record);

/// memory.l1.peak and memory.l2.peak from the statistics of stages and of L2.
void add_memory_statistics(RunRecord& record);

}  // namespace leviosim::tools
