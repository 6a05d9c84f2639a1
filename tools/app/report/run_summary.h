// What `leviosim run` prints unless tables are asked for: whether the workload fits, the stages,
// and a line for each of latency, memory, energy and trajectory, on a screen of 24 lines.
#pragma once

#include <string>

#include "tools/app/report/text_table.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// Lines that the summary of a run has at most, with the one that names its folder, which is added
/// where results are put in place.
inline constexpr int kSummaryLines = 24;

/// "verdict: fits: …": the three verdicts (result/verdict.h). One line, without its end.
std::string verdict(const RunResult& run);

/// At most kSummaryLines - 1 lines of `width` columns, where these are 80 or more. Of stages for
/// which there is no line, those with the least cycles are left out.
/// @param heading  one line, without its end
/// @param remarks  lines that stand above the stages, beyond that number
std::string run_summary(const std::string& heading, const RunResult& run, int width,
                        const std::string& remarks = {});

}  // namespace leviosim::tools
