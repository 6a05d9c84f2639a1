// Absolute errors of other estimators, as the LEVIO paper gives them:
// tools/app/validation/published/other_accuracy.csv, which is part of the program. Columns:
// sequence (EuRoC's name), estimator, loop_closure (yes or no), width, height, value, unit (m),
// source.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/study/ablate/ablation.h"

namespace leviosim::tools {

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

/// Absolute errors by sequence: those of the ablation, what the paper says of LEVIO, and others'.
/// Empty if nothing was published of the ablation's sequences.
std::string accuracy_comparison(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                                const std::vector<PaperAccuracy>& paper,
                                const std::vector<OtherAccuracy>& others);

}  // namespace leviosim::tools
