// What a chip did during some time, as far as energy depends on it: events, clock cycles, and how
// long what was powered. Worked out at read-out from what timing and counting have recorded.
//
// Every cycle and every second of a run is in one activity: what the cluster and the whole chip
// spend just by being on belongs to the cluster's stage that runs, or to the cluster's idle time;
// stages of the controller hold what the controller itself adds.
//
// Leaves out: the few instructions of forks, barriers and DMA programming, accesses that emulated
// arithmetic makes, and the camera's transfer into L2 (4800 words per frame of 160×120).
#pragma once

#include <array>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/timing.h"
#include "sim/work/counts.h"
#include "sim/work/transfers.h"

namespace leviosim::sim {

struct Activity {
  double instructions = 0;  ///< of the cluster's cores
  double f32_operations = 0;
  double l1_accesses = 0;      ///< by cores and DMA
  double transfer_cycles = 0;  ///< of the controller's clock, in which the DMA moves data
  double l2_accesses = 0;      ///< by controller, cluster, DMA and refills of instruction caches
  double controller_instructions = 0;
  double controller_f32_operations = 0;
  /// Items that accelerators served, by kind of kernel.
  std::array<double, work::kOffloadKindCount> cluster_items{};
  std::array<double, work::kOffloadKindCount> controller_items{};

  double cluster_cycles = 0;       ///< of the cluster's clock, at work
  double idle_cluster_cycles = 0;  ///< without work
  double soc_cycles = 0;           ///< of the controller's clock

  Seconds cores_working;  ///< summed over the cluster's cores
  Seconds cores_gated;
  Seconds controller_working;
  Seconds time;               ///< that the whole chip was on
  double external_bytes = 0;  ///< from and to external memory
  Seconds external_on;        ///< while it keeps something

  Activity& operator+=(const Activity& o);
};

/// Duration of clock cycles. No cycles take no time, whatever the clock.
Seconds seconds(double cycles, Hertz clock);

/// Executions of a stage on the cluster, with a team of `workers`.
/// @param counts   what cores executed
/// @param team     its core-cycles
/// @param served   calls that accelerators served
Activity cluster_activity(const ChipConfig& chip, int workers, const work::Counts& counts,
                          const work::Transferred& transfers, const MechanismCycles& team,
                          Cycles cycles, const std::vector<work::OffloadWork>& served = {});

/// Executions of a stage on the fabric controller, whose memory is L2.
Activity controller_activity(const ChipConfig& chip, const work::Counts& counts,
                             const work::Transferred& transfers, Cycles cycles,
                             const std::vector<work::OffloadWork>& served = {});

/// Time during which the cluster has nothing to do.
Activity idle_activity(const ChipConfig& chip, int workers, Seconds time);

}  // namespace leviosim::sim
