// Mean cycles of the stages that run on both paths (EPnP and 8-point), by path, and weighted by the
// paper's shares: 42.7 % of its frames took EPnP and 57.3 % the 8-point algorithm. Frames on the
// EPnP path have more matches, so a flight with another share has other means.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "tools/app/validation/frame_log.h"

namespace leviosim::tools {

/// In per cent of the frames, as printed in the paper.
inline constexpr double kPaperEpnpFrames = 42.7;
inline constexpr double kPaperEightPointFrames = 57.3;

/// Mean cycles of a call. Absent where no frame of that path came to the stage.
struct StageOnPaths {
  struct Means {
    std::optional<double> epnp;         ///< of frames that ran EPnP alone
    std::optional<double> eight_point;  ///< of frames that ran the 8-point algorithm
    std::optional<double> weighed;      ///< of both, weighted by the paper's shares
  };
  std::string_view key;  ///< of the stage, in names of references
  std::string_view title;
  Means single;    ///< on one core
  Means parallel;  ///< on N cores
};

/// The stages of the paper's table but both RANSACs.
std::vector<StageOnPaths> stages_on_paths(const FrameLog& log);

}  // namespace leviosim::tools
