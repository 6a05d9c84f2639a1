// Options of a run that is compared with the paper.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "tools/app/run/run_options.h"

namespace leviosim::tools {

/// The paper's figures are of the released program, which does some things that cost accuracy
/// (workload/PARAMETERS.md#defects-of-the-release). So does levio in such a run, unless the options
/// say otherwise.
RunOptions as_released(RunOptions options);

/// Thresholds with which the 300 frames of MH_01 have 405 keypoints on average; with the default
/// ones they have 361. The paper does not print the number, but its cycles of frame matching, which
/// compares all pairs of two frames, are those of about 400 keypoints in either frame.
inline constexpr std::array<std::string_view, 2> kPaperKeypoints{"workload.fast_threshold=15",
                                                                 "workload.harris_threshold=4000"};
/// Nothing for other profiles, and where the options choose a threshold themselves.
std::optional<RunOptions> paper_keypoints(RunOptions options);

}  // namespace leviosim::tools
