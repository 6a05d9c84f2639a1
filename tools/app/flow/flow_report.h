// What `leviosim flow` prints and writes. Pure functions of the result.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/result/run_result.h"
#include "tools/app/table/table.h"
#include "workload/flow/estimator.h"

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

/// A run of the optical flow: what every workload has, and its flows, one for each frame.
struct FlowRun {
  RunResult run;
  std::vector<flow::Flow> flows;
  std::string platform;        ///< the chip's own name
  int binning = 1;             ///< of the camera
  std::optional<double> rate;  ///< frames/s that was asked for; the recorded one if absent
};

/// Frames/s that the chip could do, on one core and on all.
std::string frame_rate_table(const FlowRun& flow);

/// Published figures of this chip beside those of the run; empty if there are none.
std::string published_table(const FlowRun& flow);

/// How many frames have a flow, and how large it is.
std::string flow_summary(const FlowRun& flow);

/// All that is printed, with the tables that all workloads share, as parts of a screen.
std::vector<std::string> flow_report(const FlowRun& flow);

/// Whether the chip keeps up with the camera, in a sentence.
std::string flow_conclusion(const FlowRun& flow);

/// A row per frame.
Table flow_rows(const FlowRun& flow);

/// The rows of published_table().
Table published_rows(const FlowRun& flow);

}  // namespace leviosim::tools
