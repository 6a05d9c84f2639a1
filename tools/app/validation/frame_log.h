// Work and cycles of each frame of a run, stage by stage. A run's sums (run_result.h) mix frames of
// different kinds; published means stand for frames of one kind.
#pragma once

#include <string_view>
#include <vector>

#include "sim/chip/work_sum.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/validation/ransac_samples.h"

namespace leviosim::tools {

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

}  // namespace leviosim::tools
