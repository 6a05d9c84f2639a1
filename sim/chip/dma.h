// The cluster's DMA: one channel from L2 into L1 and one back, which overlap. A channel delivers
// its transfers in the order in which they were programmed, the payload of one right behind that of
// the one before; a transfer that finds its channel idle waits for the first data
// (FACTS.md#cluster-dma). Meanwhile the programming core executes the rest of the call of the API.
// While data flow, they take banks of L1 from the cores (contention.h).
//
// Left out: bursts and the number that may be under way (eight of
// 256 bytes hide the latency of L2), 2D transfers, and waits of the DMA itself for banks (its ports
// are wider than the payload).
#pragma once

#include <array>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/team.h"
#include "sim/events/kernel.h"
#include "sim/events/task.h"
#include "sim/work/program.h"

namespace leviosim::sim {

/// Cycles that a blocking transfer takes from its programming until the master goes on, if no other
/// transfer is under way.
double transfer_cycles(const DmaConfig& dma, Bytes bytes);

class Dma {
 public:
  Dma(Kernel& kernel, const ClockDomain& clock, const DmaConfig& config, Team& team);

  /// When another command finds room in the queue: now, or as soon as one fewer is under way.
  Time room();
  /// A transfer that has just been programmed. Returns when its data flow: the last ones arrive at
  /// the end.
  DataTiming start(const work::Transfer& transfer);

 private:
  struct Channel {
    Time free;  ///< the last data of all transfers so far have arrived
  };

  Process disturb(Time begin, Time end);
  Duration cycles(double n) const;

  Kernel& kernel_;
  const ClockDomain& clock_;
  DmaConfig config_;
  Team& team_;
  std::array<Channel, 2> channels_{};  ///< by direction
  std::vector<Time> under_way_;        ///< ends of transfers; not kept where any number may be
};

}  // namespace leviosim::sim
