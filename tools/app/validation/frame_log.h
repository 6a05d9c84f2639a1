// What each frame of a run did and cost, stage by stage. A run's sums (run_result.h) mix frames of
// different kinds; published means stand for frames of one kind.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/chip/cost.h"
#include "sim/work/program.h"
#include "tools/app/run/simulate.h"
#include "workload/vio/stages.h"

namespace leviosim::tools {

// How many iterations each hypothesis of both RANSACs of `levio` took, from what was counted in it:
// a fork hands one hypothesis to each core. Facts: workload/PARAMETERS.md#epnp,
// #eight-point-algorithm.

struct RansacSamples {
  /// The only double arithmetic of a hypothesis is in Jacobi rotations, two products in each.
  std::vector<double> epnp_rotations;         ///< of 12×12 and 3×3, per hypothesis
  std::vector<double> eight_point_rotations;  ///< of 3×3, per hypothesis
  /// A step has 54 divisions; besides it there are 21 in a hypothesis, and one in a rotation.
  std::vector<double> eight_point_steps;  ///< of 9×9, per hypothesis
  std::vector<double> slowest_of_eight;   ///< the same, the most in a fork

  void add(const work::Job& job);
};

/// The executions of one stage in one frame.
struct LoggedStage {
  std::string_view name;
  int calls = 0;
  Cycles single;      ///< on one core
  Cycles parallel;    ///< on N cores
  sim::WorkSum work;  ///< of all cores
};

struct LoggedFrame {
  FrameResult result;
  int landmarks_before = 0;   ///< alive when the frame came: what world matching compares with
  int keyframe_features = 0;  ///< of the keyframe that frame matching compares with
  std::vector<LoggedStage> stages;

  /// Nullptr if the frame did not come to this stage.
  const LoggedStage* find(std::string_view stage) const;
};

struct LoggedIteration {
  int frame = 0;  ///< at whose start the snapshot was taken
  Cycles cycles;  ///< of the controller
};

class FrameLog : public RunObserver {
 public:
  /// @param code  of the cores that the work is timed for
  explicit FrameLog(work::CompiledFor code) : code_(code) {}
  FrameLog() = default;

  void on_front_end(const FrontEndJob& event) override;
  void on_optimiser(const OptimiserJob& event) override;

  const std::vector<LoggedFrame>& frames() const { return frames_; }
  /// Of the optimiser, without the jobs that only bring in new keyframes.
  const std::vector<LoggedIteration>& iterations() const { return iterations_; }
  const RansacSamples& ransac() const { return ransac_; }

 private:
  work::CompiledFor code_ = work::CompiledFor::Rv32imfc;
  std::vector<LoggedFrame> frames_;
  std::vector<LoggedIteration> iterations_;
  RansacSamples ransac_;
  int keyframe_features_ = 0;
};

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

// Stages that run whichever RANSAC a frame takes, on either path, and weighed as the paper's frames
// are: it prints that 42.7 % of its frames took EPnP and 57.3 % the 8-point algorithm. A flight
// that takes EPnP more often has other means, since frames on this path have more matches.

/// In per cent of the frames, as printed in the paper.
inline constexpr double kPaperEpnpFrames = 42.7;
inline constexpr double kPaperEightPointFrames = 57.3;

/// Mean cycles of a call. Absent where no frame of that path came to the stage.
struct StageOnPaths {
  struct Means {
    std::optional<double> epnp;         ///< of frames that ran EPnP alone
    std::optional<double> eight_point;  ///< of frames that ran the 8-point algorithm
    std::optional<double> weighed;      ///< of all, in the paper's shares
  };
  std::string_view key;  ///< of the stage, in names of references
  std::string_view title;
  Means single;    ///< on one core
  Means parallel;  ///< on N cores
};

/// The stages of the paper's table but both RANSACs.
std::vector<StageOnPaths> stages_on_paths(const FrameLog& log);

}  // namespace leviosim::tools
