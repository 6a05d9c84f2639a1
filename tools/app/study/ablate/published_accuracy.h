// What the LEVIO paper says of accuracy, of its golden model and of other estimators:
// tools/app/validation/published/accuracy.csv, which is part of the program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "traces/datasets/image_file.h"

namespace leviosim::tools {

/// A row of it: sequence (EuRoC's name), estimator, loop_closure (yes or no), width, height,
/// chosen_by (ate or relative; empty for other estimators), figure (ate or relative), value, unit,
/// source.
struct PublishedAccuracy {
  enum class Figure { ate, relative };  ///< [m]; [%] over kPaperLengthM

  std::string sequence;
  std::string estimator;  ///< of the golden model: the profile
  bool closes_loops = false;
  traces::ImageSize size;
  std::optional<Figure> chosen_by;  ///< of the golden model only
  Figure figure = Figure::ate;
  double value = 0;
  std::string source;

  /// Whether it is an absolute error, with parameters chosen by that where any were.
  bool is_ate() const {
    return figure == Figure::ate && chosen_by.value_or(Figure::ate) == Figure::ate;
  }
};

/// Of the paper's sub-trajectories.
inline constexpr double kPaperLengthM = 40;

/// @throws InputError with file and line
std::vector<PublishedAccuracy> parse_accuracy(const std::string& file, std::string_view text);

std::vector<PublishedAccuracy> published_accuracy();

}  // namespace leviosim::tools
