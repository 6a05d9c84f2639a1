// Statistics of the images of a recording and of features tracked in them, to compare recordings:
// what one kind of place gives an odometry, and another does not.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/table/table_files.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_preparation.h"

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

// What an image is like in itself, without other images: light, contrast, noise, sharpness.

struct PictureFigures {
  double brightness = 0;             ///< mean [grey levels]
  double contrast = 0;               ///< standard deviation [grey levels]
  double dark = 0;                   ///< share of the pixels below 20
  double glare = 0;                  ///< share of the pixels above 250
  std::vector<double> local;         ///< standard deviations in squares of 8x8 px
  std::optional<double> noise;       ///< of the smoothest squares [grey levels]
  std::optional<double> edge_width;  ///< of the strongest edges: step over steepest slope [px]
};

/// Noise: 3x3 differences to which planes give nothing (Immerkaer 1996), in squares of 8x8 px; the
/// lower tenth of those that are neither dark nor glaring.
PictureFigures picture_figures(const traces::GrayImage& image);

/// The value below which a share of the values lies, between two of them by a straight line; they
/// are sorted. There is at least one.
double quantile(std::vector<double>& values, double share);

}  // namespace leviosim::tools
