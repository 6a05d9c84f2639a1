// How often each operation occurred in a work segment, and how much code it fetched.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sim/work/code_reuse.h"
#include "sim/work/compiled_work.h"

namespace leviosim::work {

/// Kind of operation. What only holds or adds counts need not know which there are: op.h.
enum class Op : std::uint8_t;
/// How many there are; op.h holds its list against it.
inline constexpr std::size_t kOpCount = 48;
constexpr std::size_t index(Op op) { return static_cast<std::size_t>(op); }

struct OpInfo {
  Op op;
  std::string_view name;         ///< key in platform files, statistics and work traces
  std::string_view description;  ///< what one count means
};
/// All of them, by number: kOps of op.h.
std::span<const OpInfo> op_list();

/// Number of operations of each kind. A plain value: add two to merge two work segments.
struct Counts {
  std::array<std::uint64_t, kOpCount> n{};
  CodeReuse code{};         ///< bytes of code fetched, by reuse distance
  CompiledSets compiled{};  ///< of the functions visited

  constexpr std::uint64_t operator[](Op op) const { return n[index(op)]; }
  constexpr std::uint64_t& operator[](Op op) { return n[index(op)]; }

  constexpr Counts& operator+=(const Counts& other) {
    for (std::size_t i = 0; i < kOpCount; ++i) n[i] += other.n[i];
    for (std::size_t i = 0; i < kReuseClasses; ++i) code[i] += other.code[i];
    for (std::size_t i = 0; i < compiled.size(); ++i) compiled[i] += other.compiled[i];
    return *this;
  }
  friend constexpr Counts operator+(Counts a, const Counts& b) { return a += b; }
  friend constexpr bool operator==(const Counts&, const Counts&) = default;

  constexpr bool empty() const { return *this == Counts{}; }
};

/// The counters that counted scalars on this host thread add to, in the form that costs least:
/// * a load or store also counts in its upper half whether it crosses a word (access_weight), so
///   that a loop over a view has one counter to keep, not two;
/// * `branch_not_taken` counts all branches, since those of a loop are often known before it runs;
/// * of conditions that seldom hold, `branch_taken` counts all too, and the others are subtracted.
///
/// This is ambient state, as is what else is recorded while a kernel runs (code_events.h,
/// code_tracker.h, loops.h, offload_regions.h): an overloaded operator has no other place to find
/// its counter. It is thread-local, so simulations on several host threads do not meet, and
/// constant-initialised, so an access is one addition that the optimiser can fold over a loop.
inline constinit thread_local Counts tally{};
inline constinit thread_local std::uint64_t branches_not_taken_after_all = 0;

inline void count(Op op, std::uint64_t times = 1) { tally[op] += times; }

/// What one load or store adds to its counter. Fewer than 2^32 accesses of a kind may lie between
/// two readings of the tally: more than ten seconds of a core.
constexpr std::uint64_t access_weight(bool crosses_word) {
  return 1 + (std::uint64_t{crosses_word} << 32);
}

/// Operations in the form in which the tally has them.
struct RawCounts {
  std::array<std::uint64_t, kOpCount> n{};
  std::uint64_t not_taken_after_all = 0;
};
/// Counts as they are meant, without code.
Counts settled(const RawCounts& raw);

/// Returns what this thread counted since the last call, and starts again from zero.
Counts take_tally();

}  // namespace leviosim::work
