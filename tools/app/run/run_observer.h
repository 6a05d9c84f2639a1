// Observer of a run: gets every job of the chip, with the result of its frame and its timing, in
// the order in which the jobs ended in simulated time. The jobs hold all that is needed to time the
// run on another chip; native runs have none.
//
// The observer cannot change anything. References are valid during the call; a copied job stays
// valid as long as the program or, in a replay, as the trace: the names in it are literals of the
// workload, or the trace's.
#pragma once

#include "sim/soc/observer.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools {

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
  /// @throws InputError if the run cannot be observed as requested
  virtual void on_start([[maybe_unused]] const RunSubject& subject, [[maybe_unused]] int frames) {}
  virtual void on_front_end(const FrontEndJob&) {}
  virtual void on_optimiser(const OptimiserJob&) {}
};

}  // namespace leviosim::tools
