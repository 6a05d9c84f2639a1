// Statistics of the images of a recording and of features tracked in them, to compare recordings:
// what one kind of place gives an odometry, and another does not.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/app/table/table.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_file.h"

namespace leviosim::tools {

/// How a quantity is distributed over frames, features or observations.
struct ImageStatistic {
  std::string name;  ///< "depth"
  std::string unit;
  std::string over;  ///< of what it is the distribution
  std::size_t count = 0;
  double tenth = 0, median = 0, ninth_tenth = 0;  ///< quantiles 0.1, 0.5, 0.9; 0 if count is 0
};

struct ImageStatistics {
  std::string name;
  std::size_t frames = 0;
  std::vector<ImageStatistic> rows;  ///< the same quantities for every recording
};

/// An observation this far from where it should be is an outlier. [px]
inline constexpr double kOutlierPx = 2;

/// Reads all frames. Quantities that need true poses are empty without them.
/// @param progress  called with the number of each frame that is done
/// @throws InputError for images that cannot be read or a size that does not fit
ImageStatistics image_statistics(const std::string& name, const traces::Dataset& data,
                                 traces::ImageSize size,
                                 const std::function<void(std::size_t)>& progress = {});

/// A row for each quantity. Of two recordings or more also the medians of the others, and the last
/// column has the ratio of the last one's to the first one's.
std::string image_statistics_table(const std::vector<ImageStatistics>& all);

/// The same with all quantiles, as CSV: recording, quantity, unit, over, count, tenth, median,
/// ninth_tenth.
Table image_statistics_rows(const std::vector<ImageStatistics>& all);

/// Names of the quantities whose medians differ by more than a factor of 1.25; of two recordings.
std::vector<std::string> different_quantities(const ImageStatistics& a, const ImageStatistics& b);

}  // namespace leviosim::tools
