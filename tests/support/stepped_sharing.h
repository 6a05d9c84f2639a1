// Cores that share banks or a unit, stepped through cycle by cycle: what chance collisions cost on
// average is compared with these. Slow and exact for the programs that it steps through, which are
// drawn at random: loops over streams, and loops with operations of a shared unit.
//
// Everybody executes an instruction per cycle unless the bank or unit that it needs serves another;
// requests take turns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

namespace leviosim::testing {

/// What cores lost per cycle of their own work, and how often they accessed memory in it.
struct Lost {
  double stalls = 0;
  double accesses = 0;
};

/// The same two nested loops on every core. An access happens in a slot of the inner body.
struct StreamLoops {
  struct Access {
    int slot;
    long inner, outer;       ///< words further per iteration
    std::vector<long> base;  ///< first word, of each core
  };
  int slots = 0;
  int inner = 0, outer = 0;         ///< iterations
  std::vector<Access> accesses;     ///< in the order of their slots
  static constexpr int kSetUp = 8;  ///< cycles between two runs of the inner loop

  /// One to four streams, each unrolled up to four times, in a body half of which or less accesses
  /// memory. A quarter of the streams are an operand that all cores read, the others shares of
  /// arrays. An eighth go down a column. From one inner loop to the next a stream goes on, starts
  /// again, or is a row of the image further.
  static StreamLoops draw(std::mt19937& random, int cores) {
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    StreamLoops loops;
    const int streams = 1 + below(4), unrolled = 1 + below(4), n = streams * unrolled;
    loops.slots = n + 1 + below(3 * n + 2);
    loops.inner = 8 + below(57);
    loops.outer = std::max(1, 6000 / (loops.inner * loops.slots));
    const long pitch = 8 + below(160);
    std::vector<int> slots(static_cast<std::size_t>(loops.slots));
    for (int i = 0; i < loops.slots; ++i) slots[static_cast<std::size_t>(i)] = i;
    for (std::size_t i = slots.size() - 1; i > 0; --i)
      std::swap(slots[i], slots[random() % (i + 1)]);
    for (int stream = 0; stream < streams; ++stream) {
      const long step = below(8) == 0 ? pitch : 1;
      const long inner = step * unrolled;
      const long outers[] = {0, pitch, inner * loops.inner};
      const long outer = outers[below(3)];
      const bool is_common = below(4) == 0;
      const long first = below(4096), share = below(4096);
      for (int k = 0; k < unrolled; ++k) {
        Access access{slots[static_cast<std::size_t>(stream * unrolled + k)], inner, outer, {}};
        for (int core = 0; core < cores; ++core)
          access.base.push_back(first + k * step + (is_common ? 0 : core * share));
        loops.accesses.push_back(access);
      }
    }
    std::sort(loops.accesses.begin(), loops.accesses.end(),
              [](const Access& a, const Access& b) { return a.slot < b.slot; });
    return loops;
  }
};

/// Steps through the loops on word-interleaved banks.
inline Lost step_streams(const StreamLoops& loops, int cores, int banks) {
  struct Core {
    int slot = 0, inner = 0, outer = 0, set_up = 0;
    std::size_t access = 0;
    bool done = false;
  };
  std::vector<Core> all(static_cast<std::size_t>(cores));
  std::vector<int> last(static_cast<std::size_t>(banks), 0), granted, asked(all.size());
  long lost = 0, worked = 0, accesses = 0;
  const auto bank_of = [&](std::size_t i) {
    const Core& core = all[i];
    if (core.done || core.set_up > 0 || core.access == loops.accesses.size()) return -1;
    const StreamLoops::Access& access = loops.accesses[core.access];
    if (access.slot != core.slot) return -1;
    return static_cast<int>(
        (access.base[i] + core.inner * access.inner + core.outer * access.outer) % banks);
  };
  for (int running = cores; running > 0;) {
    granted.assign(static_cast<std::size_t>(banks), -1);
    const auto distance = [&](int bank, int core) {
      return (core - last[static_cast<std::size_t>(bank)] + cores - 1) % cores;
    };
    for (int i = 0; i < cores; ++i) {
      const int bank = asked[static_cast<std::size_t>(i)] = bank_of(static_cast<std::size_t>(i));
      if (bank < 0) continue;
      int& to = granted[static_cast<std::size_t>(bank)];
      if (to < 0 || distance(bank, i) < distance(bank, to)) to = i;
    }
    for (int i = 0; i < cores; ++i) {
      Core& core = all[static_cast<std::size_t>(i)];
      if (core.done) continue;
      const int bank = asked[static_cast<std::size_t>(i)];
      if (bank >= 0 && granted[static_cast<std::size_t>(bank)] != i) {
        ++lost;
        continue;
      }
      ++worked;
      if (core.set_up > 0) {
        --core.set_up;
        continue;
      }
      if (bank >= 0) {
        ++accesses;
        ++core.access;
      }
      if (++core.slot < loops.slots) continue;
      core.slot = 0;
      core.access = 0;
      if (++core.inner < loops.inner) continue;
      core.inner = 0;
      core.set_up = StreamLoops::kSetUp;
      if (++core.outer < loops.outer) continue;
      core.done = true;
      --running;
    }
    for (std::size_t bank = 0; bank < granted.size(); ++bank)
      if (granted[bank] >= 0) last[bank] = granted[bank];
  }
  return {static_cast<double>(lost) / static_cast<double>(worked),
          static_cast<double>(accesses) / static_cast<double>(worked)};
}

/// Two cores on one unit, in loops whose instructions use it or not, the second one `phase`
/// instructions ahead. Of each core, what it loses per cycle of its work.
inline std::vector<double> step_pair(const std::vector<bool>& first,
                                     const std::vector<bool>& second, std::size_t phase,
                                     int cycles) {
  const std::vector<bool>* loops[] = {&first, &second};
  std::size_t at[] = {0, phase % second.size()};
  long lost[] = {0, 0}, worked[] = {0, 0};
  int last = 0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const bool asks[] = {(*loops[0])[at[0]], (*loops[1])[at[1]]};
    const int loser = asks[0] && asks[1] ? last : -1;
    if (asks[0] || asks[1]) last = loser >= 0 ? 1 - loser : asks[1] ? 1 : 0;
    for (const int i : {0, 1}) {
      if (i == loser) {
        ++lost[i];
        continue;
      }
      ++worked[i];
      at[i] = (at[i] + 1) % loops[i]->size();
    }
  }
  return {static_cast<double>(lost[0]) / static_cast<double>(worked[0]),
          static_cast<double>(lost[1]) / static_cast<double>(worked[1])};
}

/// Cores that go round in a loop of `others` cycles, more or fewer by up to `spread`, and then ask
/// the one divider, which serves one after the other. Cycles of a round, on average.
inline double step_divider(std::mt19937& random, int cores, int others, int spread, int busy) {
  std::vector<long> asks;
  const auto loop = [&] {
    return others - spread + static_cast<long>(random() % static_cast<unsigned>(2 * spread + 1));
  };
  for (int i = 0; i < cores; ++i) asks.push_back(loop());
  long free = 0, rounds = 0;
  constexpr long kCycles = 400'000;
  for (;; ++rounds) {
    const auto next = std::min_element(asks.begin(), asks.end());
    if (*next > kCycles) break;
    free = std::max(free, *next) + busy;
    *next = free + loop();
  }
  return static_cast<double>(kCycles) * cores / static_cast<double>(rounds);
}

/// A loop that loads first and then computes: a run of operations of the unit at its end.
inline std::vector<bool> loop_with_run(std::size_t others, std::size_t uses) {
  std::vector<bool> loop(others, false);
  loop.resize(others + uses, true);
  return loop;
}

/// A loop of so many instructions, of which some use the unit, in random order.
inline std::vector<bool> draw_loop(std::mt19937& random, std::size_t size, std::size_t uses) {
  std::vector<bool> loop(size, false);
  for (std::size_t i = 0; i < uses; ++i) loop[i] = true;
  for (std::size_t i = size - 1; i > 0; --i) {
    const std::size_t k = random() % (i + 1);
    const bool kept = loop[i];
    loop[i] = loop[k];
    loop[k] = kept;
  }
  return loop;
}

}  // namespace leviosim::testing
