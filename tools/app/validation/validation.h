// A run beside the published figures: plain data, and its files.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/table/json.h"
#include "tools/app/validation/distributions.h"
#include "tools/app/validation/frame_log.h"
#include "tools/app/validation/paths.h"
#include "tools/app/validation/quantities.h"
#include "tools/app/validation/references.h"
#include "tools/app/validation/run_inputs.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {

struct Comparison {
  Reference reference;
  std::optional<double> value;  ///< of the run, in the reference's unit
  Verdict verdict = Verdict::NotCovered;

  std::optional<double> error() const {
    return value ? std::optional(error_of(reference, *value)) : std::nullopt;
  }
};

/// A figure of the paper's table of cycles beside the band of what is simulated. [kcycles]
struct BandedStage {
  std::string_view title;
  bool single = false;  ///< on one core; else on N
  double paper = 0;
  Banded simulated;
  /// In the paper's shares of frames that took either RANSAC, where the stage runs on both.
  std::optional<Banded> weighed{};

  /// By what depends less on the flight.
  bool is_inside() const { return weighed.value_or(simulated).holds(paper); }
};

/// The paper's table of cycles on the same images with as many keypoints as its frames had: no
/// guard is for these, and the rest of a validation is of the default's.
struct WithPaperKeypoints {
  std::optional<double> keypoints;      ///< of a mean frame
  std::vector<Comparison> comparisons;  ///< compute.STAGE.*, error.*
  std::vector<BandedStage> bands;
};

struct Validation {
  std::vector<Comparison> comparisons;  ///< in the order of the references
  std::vector<InputFigure> inputs;
  std::vector<InputDistribution> distributions;  ///< of `levio` only
  std::vector<NormalisedFigure> normalised;
  std::vector<StageOnPaths> paths;
  std::vector<BandedStage> bands{};  ///< where the run has them
  std::optional<WithPaperKeypoints> with_paper_keypoints{};
};

/// Quantities named error.GROUP.{mean,worst} are formed here: of the absolute errors of the
/// references compute.*.GROUP before them.
/// @throws InputError for a reference that names no quantity, or gives it another unit
std::vector<Comparison> compare(const std::vector<Reference>& references,
                                const std::vector<Quantity>& quantities);

Validation validate(const RunResult& run, const FrameLog& log, const vio::Profile& profile,
                    const std::vector<Reference>& references);
/// What a second run, with the options of paper_keypoints(), adds to the first one's.
WithPaperKeypoints part_with_paper_keypoints(const Validation& second);

/// validation.csv: a row per reference, input, normalised figure and stage on a path, the first
/// column says which.
std::string validation_csv(const Validation& validation);
Json validation_json(const Validation& validation);

}  // namespace leviosim::tools
