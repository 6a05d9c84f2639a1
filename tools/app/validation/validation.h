// A run beside the published figures: plain data, and its files.
#pragma once

#include <string>
#include <vector>

#include "tools/app/report/statistics.h"
#include "tools/app/run/run_request.h"
#include "tools/app/validation/frame_log.h"
#include "tools/app/validation/input_distributions.h"
#include "tools/app/validation/normalised.h"
#include "tools/app/validation/quantities.h"
#include "tools/app/validation/references.h"

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

struct Validation {
  std::vector<Comparison> comparisons;  ///< in the order of the references
  std::vector<InputFigure> inputs;
  std::vector<InputDistribution> distributions;  ///< of `levio` only
  std::vector<NormalisedFigure> normalised;
  std::vector<StageOnPaths> paths;
  std::vector<BandedStage> bands{};  ///< where the run has them
};

/// Quantities named error.GROUP.{mean,worst} are formed here: of the absolute errors of the
/// references compute.*.GROUP before them.
/// @throws InputError for a reference that names no quantity, or gives it another unit
std::vector<Comparison> compare(const std::vector<Reference>& references,
                                const std::vector<Quantity>& quantities);

Validation validate(const RunResult& run, const FrameLog& log, const vio::Profile& profile,
                    const std::vector<Reference>& references);

/// validation.csv: a row per reference, input, normalised figure and stage on a path, the first
/// column says which.
std::string validation_csv(const Validation& validation);
Json validation_json(const Validation& validation);

// How a run is set up that is compared with the paper.

/// The paper's figures are of the released program, which does some things that cost accuracy
/// (workload/PARAMETERS.md#defects-of-the-release). So does levio in such a run, unless the options
/// say otherwise.
RunOptions as_released(RunOptions options);

}  // namespace leviosim::tools
