// What a core waits for while it works, as the cycle breakdown knows it: names, and the cycles of
// each in a work segment.
#pragma once

#include <array>
#include <string_view>

#include "sim/chip/timing.h"

namespace leviosim::tools {

struct Wait {
  std::string_view name;
  std::string_view slice;
  double (*of)(const sim::SegmentTime&);  ///< cycles
};

/// Always in this order, since the order within a segment is not known.
inline constexpr std::array kWaits{
    Wait{"FPU", "wait: FPU", [](const sim::SegmentTime& t) { return t.fpu; }},
    Wait{"divider", "wait: divider", [](const sim::SegmentTime& t) { return t.divider; }},
    Wait{"L1 banks", "wait: L1 banks", [](const sim::SegmentTime& t) { return t.banks; }},
    Wait{"code", "wait: code", [](const sim::SegmentTime& t) { return t.alone.fetch + t.fetch; }},
    Wait{"accelerator", "wait: accelerator",
         [](const sim::SegmentTime& t) { return t.alone.accelerator + t.accelerator; }},
};

/// Cycles of a work segment in which its core does not wait.
inline double own_work(const sim::SegmentTime& t) {
  return t.alone.total() - t.alone.fetch - t.alone.accelerator;
}

}  // namespace leviosim::tools
