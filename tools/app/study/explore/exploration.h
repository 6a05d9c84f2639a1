// The paper's parameter sweep: points of the parameters, each run with every profile
// over every sequence, condensed to a result per point and profile.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/study/spread.h"
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

/// What each point sets.
using ExplorationPoints = std::vector<std::vector<vio::Assignment>>;

/// Point 0 sets nothing: the profile as it is. The others set each dimension at random, as random
/// points of a sweep are (sweep/points.h): whole numbers and toggles evenly, other numbers evenly
/// over the orders of magnitude, to four digits. A point does not depend on how many there are.
ExplorationPoints sample_points(const std::vector<Dimension>& dimensions, std::size_t count,
                                std::uint64_t seed);

/// A point with one profile.
struct ExploredPoint {
  std::size_t point = 0;
  std::string profile;
  std::vector<vio::Assignment> set;  ///< what has an effect on the profile
  std::vector<std::string> values;   ///< of the dimensions; empty for those without effect
  struct OfSequence {
    std::string sequence;
    Spread ate;       ///< [m], over seeds and folders
    Spread relative;  ///< [%]
  };
  std::vector<OfSequence> sequences;
  /// Means over the sequences of their medians; none if one of them diverged.
  std::optional<double> mean_ate;
  std::optional<double> mean_relative;
};

/// What of a point has an effect on a profile: without IMU, the noise of the IMU has none.
std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile);

/// `leviosim explore` (tools/commands/commands.h).
Command add_explore_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
