// What cores and DMA do in a stage, as slices on their tracks.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "sim/chip/account.h"
#include "tools/app/timeline/frame_events.h"
#include "tools/app/timeline/track_events.h"

namespace leviosim::tools {

struct ClusterTracks {
  std::uint64_t to_l1 = 0;
  std::uint64_t to_l2 = 0;
  std::vector<std::uint64_t> cores;  ///< by number; the master is the last
};

/// From a point in simulated time to ns, rounded down: what lies within something stays within it.
std::int64_t nanoseconds(const sim::Timebase& timebase, sim::Time time);

class CoreSlices {
 public:
  /// @param work_begin  from which cycles are counted
  CoreSlices(const ClusterTracks& tracks, const sim::Timebase& timebase, sim::Time work_begin,
             TrackEventWriter& writer)
      : tracks_(tracks),
        timebase_(timebase),
        clock_(timebase.clock("cluster")),
        work_begin_(work_begin),
        writer_(writer) {}

  void add(const StageEvents& stage);

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

// What a core waits for while it works, as the account of cycles knows it: names, and the cycles of
// each in a work segment.

struct Wait {
  std::string_view name;

  /// Cycles of all mechanisms that are this wait.
  double of(const sim::MechanismCycles& segment) const {
    double cycles = 0;
    for (const sim::MechanismInfo& info : sim::kMechanisms)
      if (info.wait == name) cycles += segment[info.mechanism];
    return cycles;
  }
};

/// In the order of the mechanisms. @returns how many there are
template <class Visit>
constexpr std::size_t visit_waits(Visit&& visit) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sim::kMechanisms.size(); ++i) {
    bool is_new = !sim::kMechanisms[i].wait.empty();
    for (std::size_t k = 0; k < i; ++k)
      if (sim::kMechanisms[k].wait == sim::kMechanisms[i].wait) is_new = false;
    if (is_new) visit(count++, sim::kMechanisms[i].wait);
  }
  return count;
}

/// Always in this order, since the order within a segment is not known.
inline constexpr auto kWaits = [] {
  std::array<Wait, visit_waits([](std::size_t, std::string_view) {})> waits;
  visit_waits([&](std::size_t i, std::string_view name) { waits[i].name = name; });
  return waits;
}();

/// Cycles of a work segment in which its core does not wait.
inline double own_work(const sim::MechanismCycles& segment) {
  return segment.alone() - segment[sim::Mechanism::Fetch] - segment[sim::Mechanism::Accelerator];
}

}  // namespace leviosim::tools
