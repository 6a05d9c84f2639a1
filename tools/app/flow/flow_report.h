// What `leviosim flow` prints and writes. Pure functions of the result.
#pragma once

#include <string>
#include <vector>

#include "tools/app/flow/published.h"
#include "workload/flow/estimator.h"

namespace leviosim::tools {

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
std::string flow_csv(const FlowRun& flow);

/// The rows of published_table().
std::string published_csv(const FlowRun& flow);

}  // namespace leviosim::tools
