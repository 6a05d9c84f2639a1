// A run beside the published figures: plain data, and its files.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/record/statistics.h"
#include "tools/app/run/run_request.h"
#include "tools/app/validation/frame_log.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {

// The figures of a run that published ones are compared with, by name. How each is formed from the
// frames is said here and nowhere else:
//
//   compute.STAGE.single, .multi [kcycles]  mean over the frames that the average stands for
//                                           (frame_log.h), on one core and on N
//   compute.STAGE.speedup [x]               one over the other
//   compute.imu_preintegration.per_sample   mean on one core; the stage is serial
//   compute.imu_preintegration.share [%]    of the front end's time on N cores
//   compute.optimiser.longest_iteration [ms]  the paper says "up to"; on the controller
//   compute.optimiser.longest_frame [ms]    the iterations on one snapshot together, the longest
//   share.epnp, share.eight_point [%]       RANSAC over the sum of extraction, both matchings and
//                                           that RANSAC, from the means above: the paper's 62.9 %
//                                           is 10323 of 2926 + 1033 + 2128 + 10323
//   latency.KIND [ms]                       mean time of the front end over the frames of a kind,
//   on
//                                           N cores, without waiting for the frame before; frames
//                                           that ran both RANSACs are of no kind
//   latency.mean, latency.single_core [ms]  over all frames but the first; on N cores and on one
//   memory.STAGE.l1_single, .l1_parallel [kB of 1000 bytes]   highest peak of all frames
//   memory.BLOCK.l2 [kB]                    persistent blocks and the optimiser's highest peak
//   memory.*.occupation… [%]                the same of the memory's nominal size

struct Quantity {
  std::string name;
  std::string unit;
  std::optional<double> value;  ///< absent if the run shows nothing of it
};

/// In a fixed order, whatever the run shows.
std::vector<Quantity> quantities_of(const RunResult& run, const FrameLog& log);

/// Kinds of frame of the paper's latency figure.
struct FrameKind {
  std::string_view key;
  std::string_view title;
  PoseSource source;
  bool keyframe;
};
inline constexpr std::array kFrameKinds{
    FrameKind{"epnp", "EPnP", PoseSource::Epnp, false},
    FrameKind{"epnp_keyframe", "EPnP, keyframe", PoseSource::Epnp, true},
    FrameKind{"eight_point", "8-point", PoseSource::EightPoint, false},
    FrameKind{"eight_point_keyframe", "8-point, keyframe", PoseSource::EightPoint, true},
};

/// Whether both RANSACs ran, which the paper's pipeline does not do.
bool ran_both(const LoggedFrame& frame);

// What a run's figures depend on, and figures that depend on it less. The paper prints cycles but
// hardly any inputs: not how many keypoints, landmarks and matches a frame had. So a difference in
// cycles may be one of the model or one of the input; cycles per unit of work make two *simulated*
// runs comparable, and tell which input would explain the paper's value.

/// An input of the run, and what is known of the paper's.
struct InputFigure {
  std::string name;  ///< "features of a frame"
  std::string key;   ///< in files
  std::string unit;
  std::optional<double> value;
  std::optional<double> paper;
  std::string_view source;  ///< of the paper's; why there is none
};

/// Cycles of a stage for a unit of its work.
struct NormalisedFigure {
  std::string stage;
  std::string unit;                        ///< "pixel", "pair of descriptors", …
  std::optional<double> units;             ///< in a mean call
  std::optional<double> single;            ///< cycles for a unit on one core
  std::optional<double> parallel;          ///< on N cores
  std::optional<double> paper_units;       ///< if the paper or its release fix them
  std::optional<double> paper_single;      ///< cycles of a mean call on one core
  std::optional<double> explaining_units;  ///< that give the paper's one-core value at our cost

  /// The paper's cycles for a unit, if both are known.
  std::optional<double> paper_per_unit() const {
    return paper_units && paper_single ? std::optional(*paper_single / *paper_units) : std::nullopt;
  }
};

std::vector<InputFigure> inputs_of(const RunResult& run, const FrameLog& log,
                                   const vio::Profile& profile);
std::vector<NormalisedFigure> normalised(const RunResult& run, const FrameLog& log,
                                         const vio::Profile& profile);

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

// How a run is set up that is compared with the paper.

/// The paper's figures are of the released program, which does some things that cost accuracy
/// (workload/PARAMETERS.md#defects-of-the-release). So does levio in such a run, unless the options
/// say otherwise.
RunOptions as_released(RunOptions options);

/// The paper does not print how many keypoints its frames have. Frame matching compares all pairs
/// of two frames: at its cycles for a pair, some 400 of either. With these thresholds, the images
/// of MH_01 that leviosim is compared on have 405, by default 361.
inline constexpr std::array<std::string_view, 2> kPaperKeypoints{"workload.fast_threshold=15",
                                                                 "workload.harris_threshold=4000"};
/// Nothing for other profiles, and where the options choose a threshold themselves.
std::optional<RunOptions> paper_keypoints(RunOptions options);

// The text that `leviosim validate` prints.

/// Stages: cycles on one core and on N and the speed-up, each beside the paper's with its error.
std::string compute_table(const std::vector<Comparison>& comparisons, int cores);

/// All other references, in groups by the first part of their names.
std::string reference_table(const Validation& validation);

/// Inputs, cycles per unit of work, and how a comparison of cycles must be read.
std::string input_table(const Validation& validation);
std::string normalised_table(const Validation& validation, int cores);

/// The paper's table of cycles beside the bands of the run; empty if it has none.
std::string band_table(const std::vector<BandedStage>& bands, int cores);

/// All of them, as parts of a screen.
std::vector<std::string> validation_report(const Validation& validation, int cores);

/// Whether a figure is outside its tolerance, or the guard of what was missed before; and in a
/// sentence how many are not.
bool is_worse(const Validation& validation);
std::string validation_conclusion(const Validation& validation);

}  // namespace leviosim::tools
