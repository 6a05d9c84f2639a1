// What the LEVIO paper says of accuracy: that of its golden model, and that of other estimators.
// Both tables, of tools/app/validation/published, are part of the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "traces/datasets/image_preparation.h"

namespace leviosim::tools {

/// A row of paper_accuracy.csv: sequence (EuRoC's name), profile, width, height, chosen_by (ate or
/// relative), figure (ate or relative), value, unit, source.
struct PaperAccuracy {
  enum class Figure { ate, relative };  ///< [m]; [%] over kPaperLengthM

  std::string sequence;
  std::string profile;
  traces::ImageSize size;
  Figure chosen_by;
  Figure figure;
  double value;
  std::string source;
};

/// Of the paper's sub-trajectories.
inline constexpr double kPaperLengthM = 40;

/// @throws InputError with file and line
std::vector<PaperAccuracy> parse_paper_accuracy(const std::string& file, std::string_view text);

std::vector<PaperAccuracy> paper_accuracy();

/// A row of other_accuracy.csv: sequence (EuRoC's name), estimator, loop_closure (yes or no),
/// width, height, value, unit (m), source.
struct OtherAccuracy {
  std::string sequence;
  std::string estimator;
  bool closes_loops = false;
  traces::ImageSize size;
  double ate_m = 0;
  std::string source;
};

/// @throws InputError with file and line
std::vector<OtherAccuracy> parse_other_accuracy(const std::string& file, std::string_view text);

std::vector<OtherAccuracy> other_accuracy();

}  // namespace leviosim::tools
