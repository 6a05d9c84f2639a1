// Looks on while a run happens: sees every job that a chip was given, with the frame it belongs to
// and how long it took, in the order in which the jobs ended in simulated time.
//
// The observer cannot change anything. References are valid during the call; a copied job stays
// valid as long as its source.
#pragma once

#include <cstdint>

#include "sim/base/units.h"
#include "sim/chip/timing.h"
#include "sim/work/program.h"

namespace leviosim::soc {

/// When a frame was processed, in simulated time since the first frame, and how long it took.
struct FrameTiming {
  std::int64_t arrival_ns = 0;
  std::int64_t start_ns = 0;  ///< front end begins (≥ arrival)
  std::int64_t end_ns = 0;    ///< its result is available
  Cycles cycles;              ///< front end on N cores
  Cycles single_cycles;       ///< front end on one core
};

/// A frame has passed the front end.
struct FrontEndJob {
  int frame = 0;                    ///< number in the run, from 0
  bool optimisation_begun = false;  ///< its start took the snapshot of an optimisation
  const FrameTiming& times;
  const work::Job& job;
  const sim::JobTiming& parallel;  ///< on the run's cores
  const sim::JobTiming& single;    ///< on one core
};

/// The controller has finished an iteration of an optimisation.
struct OptimiserJob {
  int frame = 0;      ///< number of the frame at whose start the snapshot was taken
  int iteration = 0;  ///< from 0
  bool last = false;  ///< what the iterations found is published now
  const work::Job& job;
  const sim::JobTiming& timing;
};

class Observer {
 public:
  virtual ~Observer() = default;
  /// Whether timings of jobs on the run's cores shall hold their steps (sim/chip/timing.h).
  virtual bool wants_steps() const { return false; }
  virtual void on_front_end(const FrontEndJob&) {}
  virtual void on_optimiser(const OptimiserJob&) {}
};

}  // namespace leviosim::soc
