// What fetching code costs: private instruction caches in front of one that the cores of a cluster
// share, in front of L2 (FACTS.md#instruction-caches).
//
// Work says how far apart it reuses its code (sim/work/code_reuse.h). All caches have sets of a few
// ways and replace a line of a set at random (a shift register in the hardware).
// * Code comes in loops: what is used again at distance d lies in a loop of about that size, which
//   competes with itself. If k lines of it fall on a set of w ways and each is missed with
//   probability m, a line survives the round with exp(-m k / w), so m = 1 - exp(-m k / w): none for
//   k up to w. Functions lie in memory one behind the other, in an order by chance, so k varies
//   from set to set.
// * Other misses of the same work hit these lines, too. Those of new code or of larger loops come
//   in bursts, when the core goes on to other code, and while a burst is worked off, half of what
//   the cache holds is of use, on average: of M misses per fetch, a line is hit by M d / 2 / size
//   while it is not used. Those of smaller loops within the loop come in every round, which has
//   more fetches than the loop has lines: so many times as often.
// * The shared cache is asked for what the private one lacks.
//
// Cores of a team run the same code at about the same time, and form a convoy: whoever comes first
// awaits a line, and the others, who catch up meanwhile, await it, too. So each core waits as if it
// were alone, and what a team shares is the traffic: a line is fetched from L2 once for all.
//
// The tests step through such caches line by line (tests/support/line_caches.h).
//
// Left out: prefetching (off by default), and teams of which each core is in another part of the
// code.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <unordered_map>

#include "sim/chip/config.h"
#include "sim/work/counts.h"

namespace leviosim::sim {

/// Share of its lines that a loop misses which is alone in a cache, by the class of its size.
using LoopMisses = std::array<double, work::kReuseDistances.size()>;
/// Stays valid. @param lines  of the cache, a multiple of `ways`; of `line` bytes each
const LoopMisses& loop_misses(int lines, int ways, int line);

/// What a work segment fetches from beyond a core's private cache.
struct CodeFetch {
  double stall = 0;          ///< cycles that a core waits, but for wait_for_lines()
  double requests = 0;       ///< lines that the private cache asks the shared one for
  double refills = 0;        ///< lines that the shared cache asks L2 for; of a team, for each core
  double refill_cycles = 0;  ///< for which it awaits them
};

/// The caches as one core sees them. Programs go round in loops, so the same code comes again and
/// again; what it takes is remembered. Not for several host threads at once.
class CodeFetcher {
 public:
  /// Caches of unlimited size.
  CodeFetcher() = default;
  /// @param own      size of the private cache; 0: none
  /// @param sharers  cores that run the same work at the same time
  CodeFetcher(const InstructionCacheConfig& config, Bytes own, int sharers);

  /// Not additive: code that is fetched between other code survives less.
  CodeFetch fetch(const work::CodeReuse& code) const;
  /// Lines that the shared cache delivers to a core without a private one while it executes so many
  /// instructions: such a core holds one line, and takes the next one when it is through with that.
  double lines_executed(double instructions) const;
  /// Cycles that it waits for those of them that the shared cache has.
  double wait_for_lines(double lines, const CodeFetch& fetch) const {
    return shared_hit_ * std::max(0.0, lines - fetch.refills * sharers_);
  }

  /// A cache as the equations see it.
  struct Level {
    double bytes = 0;     ///< 0: there is no such cache
    double exposure = 0;  ///< of a byte of distance to a miss per fetch
    const LoopMisses* loops = nullptr;
  };

 private:
  struct HashOfReuse {
    std::size_t operator()(const work::CodeReuse& code) const;
  };
  /// Kept at most; then all are forgotten, for long flights go on giving new ones.
  static constexpr std::size_t kMostKnown = 1 << 11;

  CodeFetch solve(const work::CodeReuse& code) const;

  double line_ = 0;  ///< bytes; 0: fetching costs nothing
  double shared_hit_ = 0;
  double refill_ = 0;  ///< cycles
  double sharers_ = 1;
  double code_size_ = 1;
  Level own_;
  Level shared_;
  mutable std::unordered_map<work::CodeReuse, CodeFetch, HashOfReuse> known_;
  /// The latest again, for the cores of a team ask the same in turn. At first: no code.
  mutable work::CodeReuse latest_code_{};
  mutable CodeFetch latest_;
};

}  // namespace leviosim::sim
