// How a run is set up that is compared with the paper.
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

/// The paper does not print how many keypoints its frames have. Frame matching compares all pairs
/// of two frames: at its cycles for a pair, some 400 of either. With these thresholds, the images
/// of MH_01 that leviosim is compared on have 405, by default 361.
inline constexpr std::array<std::string_view, 2> kPaperKeypoints{"workload.fast_threshold=15",
                                                                 "workload.harris_threshold=4000"};
/// Nothing for other profiles, and where the options choose a threshold themselves.
std::optional<RunOptions> paper_keypoints(RunOptions options);

}  // namespace leviosim::tools
