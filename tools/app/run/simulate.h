// Runs a source of work on the chip of a request and puts together what the run produced.
#pragma once

#include "sim/soc/job_source.h"
#include "sim/soc/observer.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"

namespace leviosim::tools {

// A source of work whose frames yield more than work: a pose, matches, landmarks, and what there is
// to say about the whole run. Live odometry, recorded traces and other workloads are such sources.

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

  /// Fills in what does not depend on timing, from frames that have been processed.
  virtual void describe(RunResult& result) const = 0;

 private:
  FrameResult frame_;
};

/// The workload of the request over its data, on its chip or natively.
/// @throws InputError for data or requests that cannot be run
RunResult simulate(const RunRequest& request, const ProgressCallback& progress);

/// The work of any source on the chip of the request; the rest of the request is the source's.
/// @throws InputError for a chip that cannot run it
RunResult simulate_source(const RunRequest& request, RunSource& source,
                          const ProgressCallback& progress);

// Looks on while a run happens: sees every job that a chip was given, with what its frame yielded
// and how long it took, in the order in which the jobs ended in simulated time. What an observer
// needs to re-time the run elsewhere is in the jobs; native runs have none.
//
// The observer cannot change anything. References are valid during the call; a copied job stays
// valid as long as the program or, in a replay, as the trace: the names in it are literals of the
// workload, or the trace's.

/// A frame has passed the front end.
struct FrontEndJob {
  int frame = 0;                    ///< number in the run, from 0
  bool optimisation_begun = false;  ///< its start took the snapshot of an optimisation
  const FrameResult& result;
  const work::Job& job;
  const sim::JobTiming& parallel;  ///< on the run's cores
  const sim::JobTiming& single;    ///< on one core
};

using soc::OptimiserJob;

class RunObserver {
 public:
  virtual ~RunObserver() = default;
  /// As of soc::Observer.
  virtual bool wants_steps() const { return false; }
  /// The run is about to begin. @param frames  of the camera
  /// @throws InputError if the run is none that can be looked at as was asked
  virtual void on_start([[maybe_unused]] int frames) {}
  virtual void on_front_end(const FrontEndJob&) {}
  virtual void on_optimiser(const OptimiserJob&) {}
};

}  // namespace leviosim::tools
