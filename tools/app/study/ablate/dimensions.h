// Parameters of the workload that an ablation varies, and points drawn at random from their ranges.
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

/// What --vary was given: "workload.window=4:12"; toggles take no range:
/// "workload.gravity_updates"; "paper" stands for paper_dimensions().
/// @throws InputError for unknown parameters, ranges outside of what they can be, and repetitions
std::vector<Dimension> parse_dimensions(const std::vector<std::string>& words);

/// What each point sets.
using DrawnPoints = std::vector<std::vector<vio::Assignment>>;

/// Point 0 sets nothing: the profile as it is. The others set each dimension at random, as random
/// points of a sweep are (sweep/points.h): whole numbers and toggles evenly, other numbers evenly
/// over the orders of magnitude, to four digits. A point does not depend on how many there are.
DrawnPoints sample_points(const std::vector<Dimension>& dimensions, std::size_t count,
                          std::uint64_t seed);

/// What of a point has an effect on a profile: without IMU, the noise of the IMU has none.
std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile);

/// The value of a dimension in runs of a profile that set these; empty without an effect.
std::string value_in(const Dimension& dimension, const std::string& profile,
                     const std::vector<vio::Assignment>& set);

}  // namespace leviosim::tools
