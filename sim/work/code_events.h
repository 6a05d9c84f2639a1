// What the present core executes, as a stream of events: named functions entered and left, library
// routines called. Kernels only append, which costs them next to nothing; the core's tracker
// (code_tracker.h) reads the stream in windows.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "sim/work/code_map.h"

namespace leviosim::work {

/// Library routines that stand for operations which a core has no hardware for. Their code is found
/// by these names in the sizes of compiled code. Calls of them do not cut the code of their caller
/// into pieces.
enum class Routine : std::uint8_t {
  F64Add,
  F64Sub,
  F64Mul,
  F64Div,
  F64Compare,
  F64Widen,
  F64Narrow
};

inline constexpr std::array<CodeName, 7> kRoutineNames = {
    CodeName("f64_add"),     CodeName("f64_sub"),   CodeName("f64_mul"),   CodeName("f64_div"),
    CodeName("f64_compare"), CodeName("f64_widen"), CodeName("f64_narrow")};
constexpr CodeName name_of(Routine routine) {
  return kRoutineNames[static_cast<std::size_t>(routine)];
}

/// 0: the latest function was left. Below 2^28: up to nine calls of routines, three bits each.
/// Else: the function with this hash (CodeName::key) was entered.
using CodeEvent = std::uint32_t;

/// Some events in a row, known by their hash: computed on the way, it costs less than to look at
/// them again. Hash and number of events are no neighbours here, as they are in CodeEvents: GCC
/// would copy both at once, and such a load waits for the two stores of a moment ago.
struct CodeWindow {
  std::uint64_t hash;
  std::span<const CodeEvent> events;
};

class CodeEvents {
 public:
  static constexpr CodeEvent kLeave = 0;

  void enter(CodeName function) {
    append_calls();
    append(function.key);
  }
  /// Windows end here if they can: loops then make the same windows again and again.
  void leave() {
    append_calls();
    append(kLeave);
    if (size_ >= kShortestWindow) follow_code();
  }
  /// The order of the last 32 calls since a function was entered or left is kept. More come from a
  /// loop, and pass for repetitions of these. So nothing is decided here, and the host's compiler
  /// makes one step of all calls in a row.
  void call(Routine routine) {
    calls_ = calls_ << kRoutineBits | (static_cast<CodeEvent>(routine) + 1);
    ++call_count_;
  }

  /// f(routine) for each call in an event of calls, in their order.
  template <class F>
  static void for_each_routine(CodeEvent event, F&& f) {
    for (int shift = kEventBits - kRoutineBits; shift >= 0; shift -= kRoutineBits)
      if (const CodeEvent number = event >> shift & kRoutineMask; number != 0)
        f(static_cast<Routine>(number - 1));
  }

  /// Takes the events so far. They are there until the next is added.
  CodeWindow take() {
    append_calls();
    return {std::exchange(hash_, 0), {events_.data(), std::exchange(size_, 0)}};
  }

 private:
#ifdef __SIZEOF_INT128__
  __extension__ using Calls = unsigned __int128;
#else  // a 32-bit target, for which the workload is compiled but not counted
  using Calls = std::uint64_t;
#endif
  static constexpr int kKeptCalls = 32;
  static constexpr int kCallsOfEvent = 9;
  static constexpr int kRoutineBits = 3;
  static constexpr int kEventBits = kCallsOfEvent * kRoutineBits;
  static_assert(1u << kEventBits < CodeName::kSmallest);
  static constexpr CodeEvent kRoutineMask = (1u << kRoutineBits) - 1;
  static_assert(kRoutineNames.size() <= kRoutineMask);
  static constexpr std::size_t kShortestWindow = 8;
  static constexpr std::size_t kLongestWindow = 64;

  /// Hands the window to the tracker of the present core, if there is one.
  static void follow_code();
  void append(CodeEvent event) {
    if (size_ == kLongestWindow) [[unlikely]]
      follow_code();
    events_[size_++] = event;
    hash_ = std::rotl((hash_ ^ event) * 0x9e3779b97f4a7c15u, 29);
  }
  void append_calls() {
    if (call_count_ != 0) append_all_calls();
  }
  void append_all_calls();

  Calls calls_ = 0;  ///< not appended yet: the latest, three bits each
  std::size_t size_ = 0;
  std::uint64_t hash_ = 0;  ///< of the events
  std::array<CodeEvent, kLongestWindow> events_{};
  int call_count_ = 0;
};

/// Thread-local like the tally, and for the same reason.
inline constinit thread_local CodeEvents code_events{};

}  // namespace leviosim::work
