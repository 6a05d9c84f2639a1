// Which parameters of the workload an exploration varies, and the points that it looks at.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "workload/vio/parameters.h"

namespace leviosim::tools {

struct Dimension {
  const vio::Parameter* parameter;
  double low, high;  ///< both included; whole numbers for whole parameters
};

/// The five of the paper's sweep, which states no ranges: window size, keyframe threshold, noise of
/// the reprojection, noise of the IMU (gyroscope and accelerometer), updates of gravity. Numbers
/// range from a quarter to four times the profile levio's.
std::vector<Dimension> paper_dimensions();

/// "workload.window=4:12"; toggles take no range: "workload.gravity_updates".
/// @throws InputError for unknown parameters and ranges outside of what they can be
Dimension parse_dimension(const std::string& text);

/// Point 0 sets nothing: the profile as it is. The others set each dimension at random: whole
/// numbers and toggles evenly, other numbers evenly over the orders of magnitude, to three digits.
/// A point does not depend on how many there are.
std::vector<std::vector<vio::Assignment>> sample_points(const std::vector<Dimension>& dimensions,
                                                        std::size_t count, std::uint64_t seed);

}  // namespace leviosim::tools
