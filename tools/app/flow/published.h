// Published figures of PX4FLOW on the chips that we have platforms of, and such figures from a run.
// tools/app/validation/published/px4flow.csv, compiled into the program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// What of a run a published figure is compared with.
enum class FlowFigure : std::uint8_t { FrameRate, SpeedUp, Power };

struct PublishedFlow {
  std::string platform;  ///< name of the platform
  FlowFigure figure;
  int cores = 1;
  double clock_mhz = 0;
  std::optional<double> rate;  ///< frames/s at which the power was measured
  double value = 0;
  std::string unit;
  std::string source;
};

/// All of them. @throws InputError with line and column
std::vector<PublishedFlow> published_flow();

std::string_view name_of(FlowFigure figure);

/// The figure from a run, absent if it has none: on a chip without energy figures, or
/// with another number of cores. The published clock may be another than the run's: then all clocks
/// are scaled in proportion, cycles stay the same, and the voltage is the lowest that allows it.
std::optional<double> predicted(const PublishedFlow& published, const RunResult& run);

/// A run's work with frames at another, even rate.
RunResult at_rate(RunResult run, double frames_per_second);

/// Cycles of a frame, on average over all but the first, which has no flow.
struct FlowCycles {
  double single = 0;
  double parallel = 0;
};
/// Absent for a run of less than two frames.
std::optional<FlowCycles> flow_cycles(const RunResult& run);

}  // namespace leviosim::tools
