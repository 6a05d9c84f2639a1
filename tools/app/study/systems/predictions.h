// What leviosim predicts for published systems whose workload and chip it models: how many frames
// the chip could do, and what it takes at the published rate.
//
// Left out, as in all predictions here: camera, radio and the rest of the board.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/energy/estimate.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/systems/published_systems.h"

namespace leviosim::tools {

struct Prediction {
  double most_frames_per_s = 0;  ///< that the chip could do
  /// At the published rate, the recorded one if that is lower, or what the chip can do.
  double frames_per_s = 0;
  std::optional<sim::Estimate<Watts>> power;  ///< none if the platform has no energy figures
  std::optional<sim::Estimate<Joules>> frame;
  std::string memory;  ///< how it fits, or what is missing
  bool fits = true;
};

/// A workload on the chip of a system; of a system that is not modelled, what was published.
struct SystemRow {
  PublishedSystem published;
  std::string workload = {};
  std::optional<Prediction> here = {};  ///< none if the system is not modelled
};

/// @param request   whose data, frames and seed all predictions are made with
/// @param progress  of the run of LEVIO
/// @throws InputError for data that cannot be used, Interrupted
std::vector<SystemRow> predict_systems(const std::vector<PublishedSystem>& systems,
                                       const RunRequest& request, const ProgressCallback& progress);

}  // namespace leviosim::tools
