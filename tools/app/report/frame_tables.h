// What a run showed of its frames and its trajectory, as text. Pure functions of the result.
#pragma once

#include <cstdint>
#include <string>

#include "tools/app/report/text_table.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// Mean and worst latency of the kinds of frame, against the frame period.
std::string latency_table(const RunResult& run, int width = table_width());

/// Of a closed loop: lost and late frames, percentiles of the latency. Else empty.
std::string camera_summary(const RunResult& run);

/// What the frames yielded: sources of poses, which add up, keyframes, restarts of the map, mean
/// numbers of features and matches.
std::string frame_summary(const RunResult& run);

/// Length of the trajectory, and its error with the protocol where ground truth exists.
std::string trajectory_summary(const RunResult& run);

/// The one line about the host.
std::string host_line(const RunResult& run);

/// "warning: map lost: …"; empty where the map is good (tools/app/result/verdict.h).
std::string map_warning(const RunResult& run);

}  // namespace leviosim::tools
