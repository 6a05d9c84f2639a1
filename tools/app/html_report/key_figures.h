// The few figures of a run that anybody asks for first, and where its slowest frame spends its
// time. Verdicts are those of result/verdict.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/record/record.h"

namespace leviosim::tools {

/// A stage in the frame that took longest.
struct WorstFrame {
  int frame = 0;
  double latency_ns = 0;  ///< with what it waited
  double waited_ns = 0;   ///< for the front end
  std::string stage;      ///< that took most of it; empty if not known
  double stage_ns = 0;
};

/// Where it spends its time; empty if that is not known.
std::string reason_of(const WorstFrame& worst);

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

}  // namespace leviosim::tools
