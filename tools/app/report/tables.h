// The text that `leviosim run` prints: what a run showed, for people. Pure functions of the result.
#pragma once

#include <string>
#include <vector>

#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// Stages: calls, kilocycles of a mean call on one core and on N, speed-up, milliseconds.
std::string stage_table(const RunResult& run);

/// Where the core-cycles of the team went in the stages of the cluster, in per cent. Each row adds
/// up to 100.0 as printed.
std::string breakdown_table(const RunResult& run);

/// Mean and worst latency of the kinds of frame, against the frame period.
std::string latency_table(const RunResult& run);

/// Of a closed loop: lost and late frames, percentiles of the latency. Else empty.
std::string camera_summary(const RunResult& run);

/// Peaks in L1 and L2, and the blocks that were alive at them.
std::string memory_table(const RunResult& run);

/// What the frames yielded: sources of poses, keyframes, mean numbers of features and matches.
std::string frame_summary(const RunResult& run);

/// Length of the trajectory, and its error with the protocol where ground truth exists.
std::string trajectory_summary(const RunResult& run);

/// The one line about the host.
std::string host_line(const RunResult& run);

/// All of the above that apply; a native run has no timing and no occupation.
std::string report(const RunResult& run);

/// Per cent with one decimal that add up to 100.0: each part is rounded down, and the largest
/// remainders are rounded up. All zero if the parts add up to nothing.
std::vector<double> tenths_of_percent(const std::vector<double>& parts);

}  // namespace leviosim::tools
