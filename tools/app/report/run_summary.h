// What `leviosim run` prints unless tables are asked for: whether the workload fits, the stages,
// and a line for each of latency, memory, energy and trajectory, on a screen of 24 lines.
#pragma once

#include <string>

#include "tools/app/report/text_table.h"
#include "tools/app/result/run_result.h"

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

}  // namespace leviosim::tools
