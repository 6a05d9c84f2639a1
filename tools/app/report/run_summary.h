// The summary that `leviosim run` prints without --tables: whether the workload fits, the stages,
// and a line for each of latency, memory, energy and trajectory, on a screen of 24 lines.
#pragma once

#include <string>

#include "tools/app/result/run_result.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {

/// "verdict: fits: …": the three verdicts (result/verdict.h). One line, without its end.
std::string verdict(const RunResult& run);

/// At most kScreenLines lines of `width` columns, where these are 80 or more, with those that are
/// added: where results are, and what to do next. Of stages for which there is no line, those with
/// the least cycles are left out.
/// @param heading  one line, without its end
/// @param others   lines of the screen that others take
std::string run_summary(const std::string& heading, const RunResult& run, int width,
                        int others = 0);

/// Mean and worst latency of the kinds of frame, against the frame period.
std::string latency_table(const RunResult& run, int width = table_width());

/// Of a closed loop: lost and late frames, percentiles of the latency. Else empty.
std::string camera_summary(const RunResult& run);

/// Results of the frames: sources of poses, which add up, keyframes, restarts of the map, mean
/// numbers of features and matches.
std::string frame_summary(const RunResult& run);

/// Length of the trajectory, and its error with the protocol where ground truth exists.
std::string trajectory_summary(const RunResult& run);

/// The one line about the host.
std::string host_line(const RunResult& run);

/// "warning: map lost: …"; empty where the map is good (tools/app/result/verdict.h).
std::string map_warning(const RunResult& run);

}  // namespace leviosim::tools
