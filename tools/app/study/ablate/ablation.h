// The paper's ablation: every profile at every image size over every sequence, each with several
// seeds, condensed to a row per combination.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
#include "tools/app/study/point.h"
#include "tools/app/study/spread.h"

namespace leviosim::tools {

struct AblationRow {
  std::string sequence;  ///< empty: the mean over all sequences
  traces::ImageSize size;
  std::string profile;
  /// Over seeds and folders of the sequence; medians only in a mean. Of relative errors, runs is 0
  /// where the path is too short for any.
  Spread ate;       ///< [m]
  Spread relative;  ///< [%]
  struct Paper {
    double value;
    traces::ImageSize size;  ///< of the images it was found with
  };
  std::optional<Paper> paper_ate;  ///< at the same size, else at the paper's largest
  std::optional<Paper> paper_relative;
  std::optional<double> least_completion;
  std::vector<std::string> protocols;  ///< each once
};

/// In the order of rows: sequence_names(), then sizes, then profiles; folders and seeds inside.
std::vector<Point> ablation_runs(const BatchPlan& plan);

/// A row per sequence, size and profile, and with several sequences the means over them.
std::vector<AblationRow> ablation_rows(const BatchPlan& plan, const std::vector<Point>& runs,
                                       const std::vector<RunOutcome>& outcomes,
                                       const std::vector<PublishedAccuracy>& published);

}  // namespace leviosim::tools
