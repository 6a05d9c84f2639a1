#include "sim/events/event_queue.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sim/base/error.h"

namespace leviosim::sim {

Slot EventQueue::add_slot() {
  if (!free_slots_.empty()) {
    const Slot slot = free_slots_.back();
    free_slots_.pop_back();
    return slot;
  }
  if (slots_made_ >= 1U << kSlotBits)
    throw InputError(
        "the work has more under way at once than the simulation can follow, 65536 processes: it "
        "begins too many background transfers without waiting for them");
  if (slots_made_ == nodes_.size() / 2) grow();
  return slots_made_++;
}

void EventQueue::free_slot(Slot slot) {
  set_never(slot);
  free_slots_.push_back(slot);
}

void EventQueue::grow() {
  const std::size_t leaves = nodes_.size() / 2;
  std::vector<EventKey> larger(4 * leaves, EventKey::never());
  std::copy_n(nodes_.begin() + static_cast<std::ptrdiff_t>(leaves), leaves,
              larger.begin() + static_cast<std::ptrdiff_t>(2 * leaves));
  for (std::size_t node = 2 * leaves - 1; node > 0; --node)
    larger[node] = earlier(larger[2 * node], larger[2 * node + 1]);
  nodes_ = std::move(larger);
}

}  // namespace leviosim::sim
