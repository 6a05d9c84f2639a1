// The causes of the difference between the times of a mean frame on two chips: by mechanism, in
// words and milliseconds. All causes together are the whole difference.
//
// Work that is divided among other numbers of cores, work that went to an accelerator, and another
// clock are causes of their own: none of them makes an operation cheaper.
#pragma once

#include <string>
#include <vector>

#include "sim/base/units.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// The breakdown of a run's cycles, and the clock they are of.
struct TimedParts {
  std::vector<StageParts> stages;
  int cores = 0;
  double frames = 0;
  Hertz clock;
};

struct MainCause {
  std::string what;   ///< "waiting for code"
  double ms = 0;      ///< of a mean frame; below 0: saved
  std::string stage;  ///< stage with the largest share of it
  double stage_ms = 0;
};

TimedParts timed_parts(const RunRecord& run);

/// The largest first.
std::vector<MainCause> main_causes(const TimedParts& a, const TimedParts& b);

/// Of main_causes(), those without which the difference is not explained: at most five, none of
/// less than a fiftieth of the largest.
std::vector<MainCause> worth_naming(std::vector<MainCause> causes);

/// "waiting for code -11.20 ms, most in EPnP RANSAC".
std::string cause_text(const MainCause& cause);

/// Accelerators of the chip that served nothing: "hamming (cluster)".
std::vector<std::string> unused_accelerators(const RunFigures& run);
/// "nothing of this run uses hamming (cluster), because …"; empty if B has no unused ones that A
/// has not.
std::string unused_text(const std::vector<std::string>& in_a, const std::vector<std::string>& in_b);

}  // namespace leviosim::tools
