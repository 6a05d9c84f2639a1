// Which event comes next: the total order of events, and the queue that keeps it.
//
// Events are ordered by (time, phase, sequence): first by simulated time, then by phase within one
// instant, then in the order in which they were scheduled. The order is total, so that a simulation
// has one outcome whatever the host.
//
// Whatever can be scheduled (a process, a timer) owns a slot and has at most one pending event. So
// the queue is a tournament: a binary tree over the slots in which every node holds the smaller key
// of its two children. Scheduling, moving and cancelling replay one path from leaf to root without
// an unpredictable branch, about twice as fast as binary and four-ary heaps (sim/events/README.md),
// and nothing stale is ever left behind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/events/timebase.h"

namespace leviosim::sim {

/// Order within one instant. An event may schedule another at the same instant in an earlier phase;
/// that one is then the next to run.
enum class Phase : std::uint8_t {
  Run,      ///< ends of delays and timers; processes starting
  Wake,     ///< those woken by events, barriers, semaphores, channels
  Settle,   ///< shared resources are solved again, once, after all changes of the instant
  Observe,  ///< samplers: everything else has settled
};
inline constexpr std::size_t kPhases = 4;  ///< all that 2 bits of EventKey::rank hold

using Slot = std::uint32_t;
inline constexpr unsigned kSlotBits = 16;  ///< at most 65536 processes and timers at once

/// Place of an event in the total order, and its slot. `rank`: phase in the top 2 bits, then 46
/// bits of sequence (weeks of host time), then the slot.
struct alignas(16) EventKey {
  Time time;
  std::uint64_t rank;

  static constexpr EventKey never() { return {Time::max(), ~std::uint64_t{0}}; }
  constexpr Slot slot() const { return static_cast<Slot>(rank & ((1U << kSlotBits) - 1)); }
  friend constexpr bool operator==(EventKey, EventKey) = default;
};

constexpr std::uint64_t event_rank(Phase phase, std::uint64_t sequence, Slot slot) {
  return static_cast<std::uint64_t>(phase) << 62 | sequence << kSlotBits | slot;
}

/// All ones if `b` comes before `a`, otherwise 0: the sign of the 128-bit difference. Times are not
/// negative, so the difference does not overflow.
constexpr std::int64_t before_mask(EventKey b, EventKey a) {
  return (b.time.ticks - a.time.ticks - (b.rank < a.rank ? 1 : 0)) >> 63;
}
constexpr bool operator<(EventKey b, EventKey a) { return before_mask(b, a) != 0; }

/// The one that comes first; by masks, since compilers turn a conditional into a branch here.
constexpr EventKey earlier(EventKey a, EventKey b) {
  const std::int64_t mask = before_mask(b, a);
  return {{a.time.ticks ^ ((a.time.ticks ^ b.time.ticks) & mask)},
          a.rank ^ ((a.rank ^ b.rank) & static_cast<std::uint64_t>(mask))};
}

class EventQueue {
 public:
  EventQueue() : nodes_(2, EventKey::never()) {}

  /// A slot with nothing scheduled.
  Slot add_slot();
  void free_slot(Slot slot);

  /// Schedules the slot's event, instead of the one it may have pending. key.slot() is the slot.
  void set(EventKey key) {
    const Slot slot = key.slot();
    if (slot == taken_) taken_ = kNone;
    replay(slot, key);
  }
  void cancel(Slot slot) { set_never(slot); }

  /// The next event, or never().
  EventKey first() {
    if (taken_ != kNone) set_never(taken_);
    return nodes_[1];
  }
  /// Takes the event that first() gave out of the queue. In fact it stays until the slot is set
  /// again or first() is called: a process just resumed mostly schedules itself again, which then
  /// costs one replay instead of two.
  Slot take_first() {
    taken_ = nodes_[1].slot();
    return taken_;
  }

 private:
  static constexpr Slot kNone = ~Slot{0};

  void set_never(Slot slot) {
    if (slot == taken_) taken_ = kNone;
    replay(slot, EventKey::never());
  }
  void replay(Slot slot, EventKey winner) {
    EventKey* const nodes = nodes_.data();
    std::size_t node = nodes_.size() / 2 + slot;
    nodes[node] = winner;
    for (; node > 1; node /= 2) {
      winner = earlier(winner, nodes[node ^ 1]);
      nodes[node / 2] = winner;
    }
  }
  void grow();

  std::vector<EventKey> nodes_;  // [1] is the root, [n] has children [2n], [2n+1]; leaves last
  std::vector<Slot> free_slots_;
  Slot slots_made_ = 0;
  Slot taken_ = kNone;
};

}  // namespace leviosim::sim
