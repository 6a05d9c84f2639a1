// The six stages of the LEVIO paper's compute table, and the frames over which its averages must be
// read:
//
//  - feature extraction: every frame;
//  - frame matching: every frame that has a keyframe before it;
//  - world matching: every frame that comes when the map holds a landmark;
//  - EPnP and 8-point RANSAC: "either EPnP or 8-point are calculated". Here a frame whose EPnP pose
//    is refused for its few inliers goes on with the 8-point algorithm, so it has both; each
//    RANSAC's average is over the frames that ran it;
//  - triangulation: "only done for keyframes"; the first frame only stores itself.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/chip/work_sum.h"
#include "tools/app/validation/frame_log.h"
#include "workload/vio/stages.h"

namespace leviosim::tools {

struct PaperStage {
  std::string_view key;    ///< in names of references
  std::string_view title;  ///< for people
  std::string_view stage;  ///< name in the workload
  /// Whether the average is over this frame too, if it came to the stage.
  bool (*stands_for)(const LoggedFrame&);
};

inline constexpr std::array kPaperStages{
    PaperStage{"feature_extraction", "feature extraction", vio::stages::kExtraction,
               [](const LoggedFrame&) { return true; }},
    PaperStage{"frame_matching", "frame matching", vio::stages::kFrameMatching,
               [](const LoggedFrame& f) { return f.keyframe_features > 0; }},
    PaperStage{"world_matching", "world matching", vio::stages::kWorldMatching,
               [](const LoggedFrame& f) { return f.landmarks_before > 0; }},
    PaperStage{"epnp_ransac", "EPnP RANSAC", vio::stages::kEpnp,
               [](const LoggedFrame&) { return true; }},
    PaperStage{"eight_point_ransac", "8-point RANSAC", vio::stages::kEightPoint,
               [](const LoggedFrame&) { return true; }},
    PaperStage{"triangulation", "triangulation", vio::stages::kTriangulation,
               [](const LoggedFrame& f) {
                 return f.result.keyframe && f.result.source != PoseSource::First;
               }},
};

/// A stage over the frames that its average stands for; sums, from which means are derived.
struct StageSum {
  std::int64_t frames = 0;
  Cycles single;
  Cycles parallel;
  sim::WorkSum work;
  std::int64_t pairs = 0;      ///< features of the frame × what they are compared with, see below
  std::int64_t features = 0;   ///< of these frames
  std::int64_t landmarks = 0;  ///< in the map when these frames came
  std::int64_t matches = 0;    ///< with the keyframe, of these frames

  std::optional<double> mean_single() const;
  std::optional<double> mean_parallel() const;
};

/// Descriptor pairs are counted for the two matching stages, and are 0 for the others.
StageSum sum_over(const std::vector<LoggedFrame>& frames, const PaperStage& stage);

}  // namespace leviosim::tools
