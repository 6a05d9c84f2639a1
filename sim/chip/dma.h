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
#include <limits>
#include <vector>

#include "sim/base/units.h"
#include "sim/chip/config.h"
#include "sim/work/program.h"

namespace leviosim::sim {

/// Cycles that a blocking transfer takes from its programming until the master goes on, if no other
/// transfer is under way.
double transfer_cycles(const DmaConfig& dma, Bytes bytes);

/// From one instant until another, in cycles since the job began.
struct Interval {
  Cycles begin;
  Cycles end;
};

/// What the DMA moves in L1 while cores work.
class Traffic {
 public:
  static constexpr Cycles kNever{std::numeric_limits<std::int64_t>::max()};
  /// Each is looked at with every change, so that more would take for ever.
  static constexpr std::size_t kMostUnderWay = 4096;

  explicit Traffic(double words_of_a_channel) : words_(words_of_a_channel) {}

  /// @throws InputError if more are under way than any program needs (kMostUnderWay)
  void add(const Interval& data);
  /// Nobody will ask for earlier instants.
  void forget(Cycles before);
  /// Words per cycle that flow from an instant on, until the next change.
  double words(Cycles now) const;
  /// The next instant at which data begin or cease to flow; or kNever.
  Cycles next_change(Cycles now) const;

 private:
  double words_;
  std::vector<Interval> data_;
};

class Dma {
 public:
  explicit Dma(const DmaConfig& config);

  /// Another job: nothing is under way.
  void begin_job();
  /// When another command finds room in the queue: now, or as soon as one fewer is under way.
  Cycles room(Cycles now);
  /// A transfer that has just been programmed. Returns when its data flow: the last ones arrive at
  /// the end.
  Interval start(const work::Transfer& transfer, Cycles now);
  /// Of transfers in the background: nobody computes during one that the master waits for.
  const Traffic& traffic() const { return traffic_; }

 private:
  DmaConfig config_;
  Traffic traffic_;
  std::array<Cycles, 2> free_{};   ///< by direction: the last data of all transfers have arrived
  std::vector<Cycles> under_way_;  ///< ends of transfers; not kept where any number may be
};

}  // namespace leviosim::sim
