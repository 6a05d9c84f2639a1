// Distributions of the stages' inputs over a run of `levio`, beside those of the released program
// on the 300 frames of MH_01 (published/released_inputs.csv).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/validation/frame_log.h"

namespace leviosim::tools {

/// Mean, the 10th, 50th and 90th percentile (linear between order statistics), and the largest.
inline constexpr std::array<std::string_view, 5> kDistributionColumns{"mean", "10 %", "median",
                                                                      "90 %", "max"};
using Distribution = std::array<double, kDistributionColumns.size()>;

/// Absent if there are no samples.
std::optional<Distribution> distribution_of(std::vector<double> samples);

struct InputDistribution {
  using Cells = std::array<std::optional<double>, kDistributionColumns.size()>;
  std::string quantity;
  Cells released;   ///< absent where it is not known
  Cells simulated;  ///< absent where the run has none; of shares there is a mean only
};

/// Rows of the published file, in its order.
std::vector<InputDistribution> input_distributions(const FrameLog& log);
/// Of a file of that kind. @throws InputError with file and line, and the nearest name of a
/// quantity
std::vector<InputDistribution> input_distributions(const std::string& file, std::string_view text,
                                                   const FrameLog& log);

}  // namespace leviosim::tools
