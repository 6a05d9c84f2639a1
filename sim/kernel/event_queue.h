// Which event comes next: the order of events and the heap that keeps it.
//
// Events are ordered by (time, phase, sequence): first by simulated time, then by phase within one
// instant, then in the order in which they were scheduled. The order is total, so that a simulation
// has one outcome whatever the host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/kernel/timebase.h"

namespace leviosim::sim {

/// Order within one instant. An event may schedule another at the same instant in an earlier phase;
/// that one is then the next to run.
enum class Phase : std::uint8_t {
  Run,      ///< ends of delays and timers; processes starting
  Wake,     ///< those woken by events, barriers, semaphores, channels
  Settle,   ///< shared resources are solved again, once, after all changes of the instant
  Observe,  ///< samplers: everything else has settled
};
inline constexpr std::size_t kPhases = 4;

/// Place of an event in the total order. `rank` has the phase in its top byte, the sequence below.
struct EventKey {
  Time time;
  std::uint64_t rank;

  static constexpr EventKey first() { return {Time{-1}, 0}; }  ///< before every event
  static constexpr EventKey last() { return {Time::max(), ~std::uint64_t{0}}; }
  friend constexpr bool operator<(const EventKey& a, const EventKey& b) {
    // Without short circuit: unpredictable branches cost more than a second comparison.
    const int earlier = a.time < b.time ? 1 : 0;
    const int same = a.time == b.time ? 1 : 0;
    const int lower = a.rank < b.rank ? 1 : 0;
    return (earlier | (same & lower)) != 0;
  }
};

constexpr std::uint64_t event_rank(Phase phase, std::uint64_t sequence) {
  return static_cast<std::uint64_t>(phase) << 56 | sequence;
}

/// Four-ary heap of small entries, smallest key first. `Item` is a pointer; if what it points to has
/// a member `heap_index`, the heap keeps it up to date, and such an item can be moved and removed.
///
/// take_first() leaves the root vacant until the next push() or close_vacancy(): a process that has
/// just been resumed usually schedules itself again, and filling the root then costs one sift
/// instead of two. first_key() and take_first() need a closed vacancy.
template <class Item>
class EventHeap {
 public:
  static constexpr std::size_t kAbsent = ~std::size_t{0};

  bool empty() const { return entries_.size() == (vacant_ ? 1 : 0); }
  EventKey first_key() const { return entries_.empty() ? EventKey::last() : entries_[0].key; }

  Item take_first() {
    vacant_ = true;
    entries_[0].key = EventKey::first();  // stays the root whatever is moved meanwhile
    const Item item = entries_[0].item;
    set_index(item, kAbsent);
    return item;
  }

  void push(EventKey key, Item item) {
    if (vacant_) {
      vacant_ = false;
      return sift_down(0, {key, item});
    }
    entries_.push_back({key, item});
    sift_up(entries_.size() - 1, {key, item});
  }

  void close_vacancy() {
    if (!vacant_) return;
    vacant_ = false;
    const Entry moved = entries_.back();
    entries_.pop_back();
    if (!entries_.empty()) sift_down(0, moved);
  }

  /// Gives the entry at `index` another key.
  void move(std::size_t index, EventKey key) { place_again(index, {key, entries_[index].item}); }

  void remove(std::size_t index) {
    set_index(entries_[index].item, kAbsent);
    const Entry moved = entries_.back();
    entries_.pop_back();
    if (index < entries_.size()) place_again(index, moved);
  }

 private:
  struct Entry {
    EventKey key;
    Item item;
  };
  static constexpr std::size_t kArity = 4;
  static constexpr bool kTracked = requires(Item item) { item->heap_index; };

  static void set_index(Item item, std::size_t index) {
    if constexpr (kTracked) item->heap_index = index;
  }
  void put(std::size_t index, const Entry& entry) {
    entries_[index] = entry;
    set_index(entry.item, index);
  }

  void sift_up(std::size_t index, const Entry entry) {
    while (index > 0) {
      const std::size_t parent = (index - 1) / kArity;
      if (!(entry.key < entries_[parent].key)) break;
      put(index, entries_[parent]);
      index = parent;
    }
    put(index, entry);
  }

  void sift_down(std::size_t index, const Entry entry) {
    const std::size_t size = entries_.size();
    for (std::size_t first = kArity * index + 1; first < size; first = kArity * index + 1) {
      const std::size_t child = smallest_child(first, size);
      if (!(entries_[child].key < entry.key)) break;
      put(index, entries_[child]);
      index = child;
    }
    put(index, entry);
  }

  std::size_t smallest_child(std::size_t first, std::size_t size) const {
    const std::size_t end = first + kArity < size ? first + kArity : size;
    std::size_t smallest = first;
    for (std::size_t child = first + 1; child < end; ++child)
      smallest = entries_[child].key < entries_[smallest].key ? child : smallest;
    return smallest;
  }

  void place_again(std::size_t index, const Entry entry) {
    const bool up = index > 0 && entry.key < entries_[(index - 1) / kArity].key;
    up ? sift_up(index, entry) : sift_down(index, entry);
  }

  std::vector<Entry> entries_;
  bool vacant_ = false;
};

}  // namespace leviosim::sim
