// What cores and DMA do in a stage, as slices on their tracks.
#pragma once

#include <array>
#include <vector>

#include "tools/app/timeline/frame_events.h"
#include "tools/app/timeline/track_events.h"

namespace leviosim::tools {

struct ClusterTracks {
  std::array<std::uint64_t, 4> transfers{};  ///< by direction
  std::vector<std::uint64_t> cores;          ///< by number; the master is the last
};

/// From a point in simulated time to ns, rounded down: what lies within something stays within it.
std::int64_t nanoseconds(const sim::Timebase& timebase, sim::Time time);

class CoreSlices {
 public:
  /// @param clock       in whose cycles: "cluster", "controller"
  /// @param work_begin  from which cycles are counted
  CoreSlices(const ClusterTracks& tracks, const sim::Timebase& timebase, std::string_view clock,
             sim::Time work_begin, TrackEventWriter& writer)
      : tracks_(tracks),
        timebase_(timebase),
        clock_(timebase.clock(clock)),
        work_begin_(work_begin),
        writer_(writer) {}

  void add(const StageEvents& stage);
  /// Data of all its steps, on the tracks of their directions.
  void add_transfers(const StageEvents& stage);

 private:
  std::uint64_t master() const { return tracks_.cores.back(); }
  std::int64_t ns(sim::Time time) const { return nanoseconds(timebase_, time); }
  std::int64_t cycle(sim::Time time) const {
    return clock_.whole_cycles(time - work_begin_).count();
  }
  void add_step(const StepEvents& step);
  void add_master(const StepEvents& step);
  void add_work(const StepEvents& step, const CoreEvents& core);
  void add_waits(std::uint64_t track, const CoreEvents& core);
  void add_idle(const StepEvents& step, const CoreEvents& core);
  void add_transfer(const TransferEvents& transfer);

  const ClusterTracks& tracks_;
  const sim::Timebase& timebase_;
  const sim::ClockDomain& clock_;
  sim::Time work_begin_;
  TrackEventWriter& writer_;
};

}  // namespace leviosim::tools
