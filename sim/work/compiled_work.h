// What the compiled form of functions executes beside what was counted in them. A function's visit
// has means that were measured once (platform_models/code/); the sums of these means over the
// visits of a work segment give its *ratios*: executed instructions to counted ones at the costs
// of a plain instruction set, and loads whose value the next instruction needs to all loads. What
// repeats loops has a ratio of its own, for a compiler that writes a loop out spares just that, and
// a core with hardware loops does not pay it. The counts of the segment stay what they are.
//
// Left out: how both change with the data inside one function.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace leviosim::work {

enum class Compiled : std::uint8_t {
  Executed,         ///< instructions, without those of library routines
  Priced,           ///< what was counted in the same visits, as instructions
  Loads,            ///< load instructions
  LoadsUsedAtOnce,  ///< … of which the next instruction needs the value
  ExecutedLoops,    ///< of Executed, counters and branches that repeat loops
  PricedLoops,      ///< of Priced, iterations of loops
};
inline constexpr std::size_t kCompiledCount = 6;

/// Sums over visits of functions, in units of 1 / kCompiledUnit so that they are whole.
using CompiledWork = std::array<std::uint64_t, kCompiledCount>;
inline constexpr double kCompiledUnit = 16;

/// What the workload was compiled for and measured on, by the names of platform_models/code/*.csv.
enum class CompiledFor : std::uint8_t { Rv32imfc, Thumb2, Armv6, Rv32imfcXpulp };
inline constexpr std::array<std::string_view, 4> kCompiledFor = {"rv32imfc", "thumb2", "armv6",
                                                                 "rv32imfc_xpulp"};

/// The sums of all of these, one after the other: work is counted once for all chips.
using CompiledSets = std::array<std::uint64_t, kCompiledFor.size() * kCompiledCount>;

inline CompiledWork compiled_of(const CompiledSets& sets, CompiledFor set) {
  CompiledWork work;
  for (std::size_t i = 0; i < kCompiledCount; ++i)
    work[i] = sets[static_cast<std::size_t>(set) * kCompiledCount + i];
  return work;
}
inline void set_compiled(CompiledSets& sets, CompiledFor set, const CompiledWork& work) {
  for (std::size_t i = 0; i < kCompiledCount; ++i)
    sets[static_cast<std::size_t>(set) * kCompiledCount + i] = work[i];
}

/// The ratio of two sums.
/// @return `otherwise` if no function was measured
inline double compiled_ratio(const CompiledWork& work, Compiled part, Compiled whole,
                             double otherwise) {
  const std::uint64_t all = work[static_cast<std::size_t>(whole)];
  if (all == 0) return otherwise;
  return static_cast<double>(work[static_cast<std::size_t>(part)]) / static_cast<double>(all);
}

}  // namespace leviosim::work
