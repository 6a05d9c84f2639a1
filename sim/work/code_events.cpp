#include "sim/work/code_events.h"

#include <utility>

namespace leviosim::work {

void CodeEvents::append_all_calls() {
  constexpr int kHighest = (kKeptCalls - 1) / kCallsOfEvent * kEventBits;
  constexpr Calls kKept = (Calls{1} << (kKeptCalls * kRoutineBits)) - 1;
  Calls calls = std::exchange(calls_, 0) & kKept;
  for (int left = std::exchange(call_count_, 0); left > 0; left -= kKeptCalls) {
    if (left < kKeptCalls) calls &= (Calls{1} << (left * kRoutineBits)) - 1;  // the latest
    for (int shift = kHighest; shift >= 0; shift -= kEventBits) {
      const auto event =
          static_cast<CodeEvent>(calls >> shift) & ((CodeEvent{1} << kEventBits) - 1);
      if (event != 0) append(event);
    }
  }
}

}  // namespace leviosim::work
