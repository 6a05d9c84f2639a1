// The paper's ablation and its parameter sweep: every profile at every image size over every
// sequence, each with several seeds, and as it is or with parameters drawn at random; condensed to
// a row per combination.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/study/ablate/dimensions.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
#include "tools/app/study/point.h"
#include "tools/app/study/spread.h"

namespace leviosim::tools {

struct Ablation {
  BatchPlan plan;
  std::vector<Dimension> dimensions;  ///< empty: profiles as they are
  DrawnPoints points{{}};             ///< of each profile
};

struct AblationRow {
  std::string sequence{};  ///< empty: the mean over all sequences
  traces::ImageSize size;
  std::string profile;
  std::size_t point = 0;             ///< 0: the profile as it is
  std::vector<vio::Assignment> set;  ///< what of the point has an effect on the profile
  /// Over seeds and folders of the sequence; medians only in a mean. Of relative errors, runs is 0
  /// where the path is too short for any.
  Spread ate{};       ///< [m]
  Spread relative{};  ///< [%]
  struct Paper {
    double value;
    traces::ImageSize size;  ///< of the images it was found with
  };
  std::optional<Paper> paper_ate{};  ///< at the same size, else at the paper's largest
  std::optional<Paper> paper_relative{};
  std::optional<double> least_completion{};
  std::vector<std::string> protocols{};  ///< each once
};

/// In the order of rows: sequence_names(), sizes, profiles, then points; folders and seeds inside.
/// The ablation must outlive them. @throws Interrupted
std::vector<Point> ablation_runs(const Ablation& ablation);

/// A row per sequence, size, profile and point, and with several sequences the means over them.
std::vector<AblationRow> ablation_rows(const Ablation& ablation, const std::vector<Point>& runs,
                                       const std::vector<RunOutcome>& outcomes,
                                       const std::vector<PublishedAccuracy>& published);

/// The row of a profile with the least median, of means where there are several sequences; nullptr
/// if all diverged. The earlier one of equals.
const AblationRow* best_row(const std::vector<AblationRow>& rows, const std::string& profile,
                            Spread AblationRow::*by);

/// The same of the profile as it is.
const AblationRow* row_as_it_is(const std::vector<AblationRow>& rows, const std::string& profile);

}  // namespace leviosim::tools
