// A source of work whose frames yield more than work: a pose, matches, landmarks, and what there is
// to say about the whole run. Live odometry, recorded traces and other workloads are such sources.
#pragma once

#include "sim/soc/job_source.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools {

class RunSource : public soc::JobSource {
 public:
  /// Processes the frame that was begun, and keeps what it yielded.
  const work::Job& process_frame() final {
    frame_ = {};
    return process(frame_);
  }
  /// The same. `result` is filled in but for times.
  virtual const work::Job& process(FrameResult& result) = 0;
  /// Frames before the last one whose poses it may correct, at most.
  virtual int frames_that_wait() const { return 0; }
  /// What the frame that was processed last yielded.
  const FrameResult& frame() const { return frame_; }

  virtual RunSubject subject() const = 0;
  /// Fills in what else does not depend on timing, from frames that have been processed.
  virtual void describe(RunResult& result) const = 0;

 private:
  FrameResult frame_;
};

}  // namespace leviosim::tools
