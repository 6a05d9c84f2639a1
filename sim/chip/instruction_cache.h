// What fetching code costs: private instruction caches in front of one that the cores of a cluster
// share, in front of L2 (FACTS.md#instruction-caches).
//
// Work says how far apart it reuses its code (sim/work/code_reuse.h). Both levels replace lines at
// random (a shift register in the hardware), so a line survives each miss of its cache with
// probability 1 - 1/lines; with a share m of misses, a line that is used again after r times the
// cache's capacity survives with exp(-m r). For code in a loop, r is the same for all lines, and
// m = 1 - exp(-m r) gives the share that is missed: none up to r = 1.
//
// Cores of a team run the same code, each at its own place in its loops. Whoever comes first brings
// a line into the shared cache for all: of n cores at random places of the loop, the last use of a
// line by any of them lies a share g of the loop back, where P(g > x) = (1 - x)^(n-1), and during
// it all n of them miss.
//
// Left out: conflicts between the four ways of a set below the capacity, prefetching (off by
// default), and cores that wait for a line which another one is fetching already.
#pragma once

#include <array>

#include "sim/chip/config.h"
#include "sim/work/counts.h"

namespace leviosim::sim {

/// Share of fetches that miss a cache of random replacement.
/// @param reuse    reuse distance over the cache's capacity
/// @param sharers  cores that run the same code on this cache, at random places of it
double miss_share(double reuse, int sharers);

/// What a work segment fetches from beyond a core's private cache.
struct CodeFetch {
  double stall = 0;          ///< cycles that a lone core waits
  double requests = 0;       ///< lines that the private cache asks the shared one for
  double refills = 0;        ///< lines that the shared cache asks L2 for
  double refill_cycles = 0;  ///< for which it awaits them
};

/// The caches as one core sees them, its misses worked out for every class of reuse distance.
class CodeFetcher {
 public:
  /// Caches of unlimited size.
  CodeFetcher() = default;
  /// @param own      size of the private cache; 0 for none, then the shared one answers at once
  /// @param sharers  cores that run the same work at the same time
  CodeFetcher(const InstructionCacheConfig& config, Bytes own, int sharers);

  CodeFetch fetch(const work::CodeReuse& code) const;

 private:
  double shared_miss_ = 0;
  struct PerByte {
    double stall = 0;
    double requests = 0;
    double refills = 0;
  };
  std::array<PerByte, work::kReuseClasses> per_byte_{};
};

}  // namespace leviosim::sim
