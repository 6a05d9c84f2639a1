// The figures of a run that are compared with published ones, by name, and how each is computed
// from the frames:
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
//                                           on N cores, without waiting for the frame before; frames
//                                           that ran both RANSACs are of no kind
//   latency.mean, latency.single_core [ms]  over all frames but the first; on N cores and on one
//   memory.STAGE.l1_single, .l1_parallel [kB of 1000 bytes]   highest peak of all frames
//   memory.BLOCK.l2 [kB]                    persistent blocks and the optimiser's highest peak
//   memory.*.occupation… [%]                the same of the memory's nominal size
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/validation/frame_log.h"

namespace leviosim::tools {

struct Quantity {
  std::string name;
  std::string unit;
  std::optional<double> value;  ///< absent if the run has none
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

}  // namespace leviosim::tools
