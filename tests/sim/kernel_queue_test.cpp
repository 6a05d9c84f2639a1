// The event queue against an ordered set, under random operations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "sim/events/event_queue.h"

namespace leviosim::sim {
namespace {

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t bound) {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return (z ^ (z >> 31)) % bound;
  }

 private:
  std::uint64_t state_;
};

/// The same interface, the slow way.
class Reference {
 public:
  void set(EventKey key) { keys_.insert_or_assign(key.slot(), key); }
  void cancel(Slot slot) { keys_.erase(slot); }
  EventKey first() const {
    EventKey best = EventKey::never();
    for (const auto& [slot, key] : keys_)
      if (std::pair(key.time, key.rank) < std::pair(best.time, best.rank)) best = key;
    return best;
  }

 private:
  std::map<Slot, EventKey> keys_;
};

TEST(EventKey, OrdersByTimeThenPhaseThenSequence) {
  const auto key = [](std::int64_t time, Phase phase, std::uint64_t sequence, Slot slot) {
    return EventKey{Time{time}, event_rank(phase, sequence, slot)};
  };
  const std::vector<EventKey> ordered = {
      key(0, Phase::Run, 5, 9),         key(0, Phase::Run, 6, 1), key(0, Phase::Wake, 2, 0),
      key(0, Phase::Observe, 1, 3),     key(1, Phase::Run, 0, 0), key(1, Phase::Settle, 0, 0),
      key(1LL << 62, Phase::Run, 0, 0), EventKey::never()};
  for (std::size_t a = 0; a < ordered.size(); ++a) {
    for (std::size_t b = 0; b < ordered.size(); ++b) {
      EXPECT_EQ(ordered[a] < ordered[b], a < b) << a << " " << b;
      EXPECT_EQ(earlier(ordered[a], ordered[b]), ordered[std::min(a, b)]);
    }
  }
}

TEST(EventQueue, EmptyAtFirst) {
  EventQueue queue;
  EXPECT_EQ(queue.first(), EventKey::never());
  queue.add_slot();
  EXPECT_EQ(queue.first(), EventKey::never());
}

TEST(EventQueue, SlotsAreRecycled) {
  EventQueue queue;
  const Slot a = queue.add_slot();
  const Slot b = queue.add_slot();
  EXPECT_NE(a, b);
  queue.set({Time{5}, event_rank(Phase::Run, 0, a)});
  queue.free_slot(a);
  EXPECT_EQ(queue.first(), EventKey::never());
  EXPECT_EQ(queue.add_slot(), a);
  EXPECT_EQ(queue.first(), EventKey::never());
}

TEST(EventQueue, AgreesWithAnOrderedSet) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    EventQueue queue;
    Reference reference;
    std::vector<Slot> slots = {queue.add_slot()};
    std::uint64_t sequence = 0;
    std::int64_t now = 0;
    const auto set_some = [&](Slot slot) {
      const Time time{now + static_cast<std::int64_t>(random.below(8))};
      const EventKey key{time, event_rank(static_cast<Phase>(random.below(4)), sequence++, slot)};
      queue.set(key);
      reference.set(key);
    };
    for (int step = 0; step < 2000; ++step) {
      if (slots.size() < 40 && random.below(20) == 0) slots.push_back(queue.add_slot());
      const Slot slot = slots[random.below(slots.size())];
      const std::uint64_t action = random.below(10);
      if (action < 4) {
        set_some(slot);
      } else if (action < 5) {
        queue.cancel(slot);
        reference.cancel(slot);
      } else {
        const EventKey expected = reference.first();
        ASSERT_EQ(queue.first(), expected) << "seed " << seed << " step " << step;
        if (expected == EventKey::never()) continue;
        now = expected.time.ticks;
        EXPECT_EQ(queue.take_first(), expected.slot());
        reference.cancel(expected.slot());
        // While the taken event is still in place: others are set, and mostly it itself again.
        if (random.below(2) == 0) set_some(slot);
        if (random.below(3) != 0) set_some(expected.slot());
      }
    }
  }
}

}  // namespace
}  // namespace leviosim::sim
