// The jobs of a run, kept so that they can be timed again on other chips. What they occupy in
// memory is left out; about 1 MB for a frame.
#pragma once

#include <vector>

#include "tools/run/run_observer.h"

namespace leviosim::tools {

struct RecordedFrame {
  PoseSource source = PoseSource::First;
  work::Job job;
};

class RecordedRun : public RunObserver {
 public:
  void on_front_end(const FrontEndJob& event) override;
  void on_optimiser(const OptimiserJob& event) override;

  const std::vector<RecordedFrame>& frames() const { return frames_; }
  /// One per iteration of the optimiser.
  const std::vector<work::Job>& iterations() const { return iterations_; }

 private:
  std::vector<RecordedFrame> frames_;
  std::vector<work::Job> iterations_;
};

}  // namespace leviosim::tools
