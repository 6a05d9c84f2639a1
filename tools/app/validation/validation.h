// A run beside the published figures: plain data, and its files.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/report/statistics.h"
#include "tools/app/run/run_request.h"
#include "tools/app/validation/frame_log.h"
#include "tools/app/validation/normalised.h"
#include "tools/app/validation/quantities.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {

// How the inputs of the stages are distributed over a run of `levio`, beside those of the released
// program on the 300 frames of MH_01 (published/released_inputs.csv).

/// Mean, the 10th, 50th and 90th percentile (linear between order statistics), and the largest.
inline constexpr std::array<std::string_view, 5> kDistributionColumns{"mean", "10 %", "median",
                                                                      "90 %", "max"};
using Distribution = std::array<double, kDistributionColumns.size()>;

/// Absent if there are no samples.
std::optional<Distribution> distribution_of(std::vector<double> samples);

struct InputDistribution {
  using Cells = std::array<std::optional<double>, kDistributionColumns.size()>;
  std::string quantity;
  Cells released;   ///< absent where it is not known
  Cells simulated;  ///< absent where the run has none; of shares there is a mean only
};

/// Rows of the published file, in its order.
std::vector<InputDistribution> input_distributions(const FrameLog& log);
/// Of a file of that kind. @throws InputError with file and line, and the nearest name of a
/// quantity
std::vector<InputDistribution> input_distributions(const std::string& file, std::string_view text,
                                                   const FrameLog& log);

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

// The text that `leviosim validate` prints.

/// Stages: cycles on one core and on N and the speed-up, each beside the paper's with its error.
std::string compute_table(const Validation& validation, int cores);

/// All other references, in groups by the first part of their names.
std::string reference_table(const Validation& validation);

/// Inputs, cycles per unit of work, and how a comparison of cycles must be read.
std::string input_table(const Validation& validation);
std::string normalised_table(const Validation& validation, int cores);

/// The paper's table of cycles beside the bands of the run; empty if it has none.
std::string band_table(const Validation& validation, int cores);

/// All of them, as parts of a screen.
std::vector<std::string> validation_report(const Validation& validation, int cores);

/// Whether a figure is outside its tolerance, or the guard of what was missed before; and in a
/// sentence how many are not.
bool is_worse(const Validation& validation);
std::string validation_conclusion(const Validation& validation);

}  // namespace leviosim::tools
