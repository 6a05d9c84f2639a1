// Where the work of a run comes from: a workload that computes it now, or a trace of an earlier
// run. The simulation asks for it in the order of simulated time, so a live source sees the data
// that a chip of that speed would have seen.
//
//   begin_frame(frame)  the front end begins a frame; an optimisation may begin with it
//   process_frame()     what the front end does with it
//   optimise()          the iterations of that optimisation, maybe during later frames
//   publish()           it has ended: what it found is visible to frames that begin from now on
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/soc/run_account.h"
#include "sim/work/program.h"

namespace leviosim::soc {

/// The front end begins a frame.
struct FrameStart {
  int frame = 0;              ///< number in the run, from 0
  std::int64_t start_ns = 0;  ///< simulated time
  bool optimiser_busy = false;
  /// The frame with which the optimisation began whose result was published last; -1: none yet.
  int seen = -1;
};

class JobSource {
 public:
  virtual ~JobSource() = default;

  virtual int frames() const = 0;
  /// Time stamp of the camera.
  virtual std::int64_t time_ns(int frame) const = 0;
  /// When the camera delivers it: simulated time since the first.
  virtual std::int64_t arrival_ns(int frame) const { return time_ns(frame) - time_ns(0); }

  /// Numbers rise; frames that the camera dropped are left out.
  /// @returns whether an optimisation begins; never while the optimiser is busy
  virtual bool begin_frame(const FrameStart& start) = 0;
  /// Of the frame that was begun. Its work is valid until the next frame begins.
  virtual const work::Job& process_frame() = 0;

  /// How many iterations the optimisation that began last has.
  virtual int iterations() const = 0;
  /// The next of them. Valid until the one after.
  virtual const work::Job& optimise() = 0;
  virtual void publish() = 0;

  /// Cycles of its cores that the job takes which was handed out last, where that is known: its
  /// work is not looked at then.
  virtual std::optional<Cycles> known_cycles() const { return std::nullopt; }

  /// Names and units of the stages.
  virtual std::vector<StageResult> empty_stages() const = 0;
};

}  // namespace leviosim::soc
