// Whether a run fits its chip and its deadline, in a sentence with the reason; and the few figures
// that anybody asks for first.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/comparison/run_record.h"

namespace leviosim::tools {

/// A stage in the frame that took longest.
struct WorstFrame {
  int frame = 0;
  double latency_ns = 0;
  std::string stage;  ///< that took most of it; empty if not known
  double stage_ns = 0;
};

struct FitVerdict {
  std::optional<bool> fits;  ///< absent for native runs, which have no times
  std::string sentence;
  std::string why;  ///< where the worst frame spends its time; may be empty
};

FitVerdict verdict_of(const RunRecord& run, const std::optional<WorstFrame>& worst);

/// A figure of the first screen, as text.
struct KeyFigure {
  std::string title;
  std::string value;
  std::string unit;
  std::string note;
  std::optional<double> share = {};  ///< of what there is: of the deadline, of a memory
};

/// Those that the run has.
/// @param protocol  of its accuracy; without one, the error is left out
std::vector<KeyFigure> key_figures(const RunRecord& run, const std::string& protocol);

/// Between two frames of the camera. [ns]
double deadline_ns(const RunRecord& run);

}  // namespace leviosim::tools
