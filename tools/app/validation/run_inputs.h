// What a run's figures depend on, and figures that depend on it less. The paper prints cycles but
// hardly any inputs: not how many keypoints, landmarks and matches a frame had. So a difference in
// cycles may be one of the model or one of the input; cycles per unit of work make two *simulated*
// runs comparable, and tell which input would explain the paper's value.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/validation/frame_log.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {

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
  std::optional<double> units;             ///< units of work in a mean call
  std::optional<double> single;            ///< cycles for a unit on one core
  std::optional<double> parallel;          ///< on N cores
  std::optional<double> paper_units;       ///< if the paper or its release fix them
  std::optional<double> paper_single;      ///< cycles of a mean call on one core
  std::optional<double> explaining_units;  ///< units that would give the paper's one-core cycles

  /// The paper's cycles for a unit, if both are known.
  std::optional<double> paper_per_unit() const {
    return paper_units && paper_single ? std::optional(*paper_single / *paper_units) : std::nullopt;
  }
};

std::vector<InputFigure> inputs_of(const RunResult& run, const FrameLog& log,
                                   const vio::Profile& profile);
std::vector<NormalisedFigure> normalised(const RunResult& run, const FrameLog& log,
                                         const vio::Profile& profile);

}  // namespace leviosim::tools
