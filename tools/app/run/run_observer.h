// Looks on while a run happens: sees every job that a chip was given, with what its frame yielded
// and how long it took, in the order in which the jobs ended in simulated time. What an observer
// needs to re-time the run elsewhere is in the jobs; native runs have none.
//
// The observer cannot change anything. References are valid during the call; a copied job stays
// valid as long as the program or, in a replay, as the trace: the names in it are literals of the
// workload, or the trace's.
#pragma once

#include <algorithm>
#include <vector>

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
  /// @throws InputError if the run is none that can be looked at as was asked
  virtual void on_start([[maybe_unused]] int frames) {}
  virtual void on_front_end(const FrontEndJob&) {}
  virtual void on_optimiser(const OptimiserJob&) {}
};

/// Several that look on, in their order.
class RunObservers : public RunObserver {
 public:
  /// @param observer  outlives this
  void add(RunObserver& observer) { observers_.push_back(&observer); }

  bool wants_steps() const override {
    return std::any_of(observers_.begin(), observers_.end(),
                       [](const RunObserver* observer) { return observer->wants_steps(); });
  }
  void on_start(int frames) override {
    for (RunObserver* observer : observers_) observer->on_start(frames);
  }
  void on_front_end(const FrontEndJob& job) override {
    for (RunObserver* observer : observers_) observer->on_front_end(job);
  }
  void on_optimiser(const OptimiserJob& job) override {
    for (RunObserver* observer : observers_) observer->on_optimiser(job);
  }

 private:
  std::vector<RunObserver*> observers_;
};

}  // namespace leviosim::tools
