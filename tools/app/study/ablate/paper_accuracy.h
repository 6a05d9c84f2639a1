// What the LEVIO paper says of the golden model's accuracy:
// tools/app/validation/published/paper_accuracy.csv, which is part of the program. Columns:
// sequence (EuRoC's name), profile, width, height, chosen_by (ate or relative), figure (ate or
// relative), value, unit, source.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "traces/datasets/image_preparation.h"

namespace leviosim::tools {

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

}  // namespace leviosim::tools
