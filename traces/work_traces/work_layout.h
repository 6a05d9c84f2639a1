// Numbers in the frames of a work trace (FORMAT.md) that its writer and reader share.
#pragma once

#include <cstdint>

namespace leviosim::traces {

/// Kinds of step.
enum : std::uint64_t {
  kSerial,
  kFork,
  kForkWithMaster,
  kTransfer,
  kBackgroundTransfer,
  kWait,
  kForkAlignedOnOneCore
};
inline constexpr std::uint64_t kStepKinds = kForkAlignedOnOneCore + 1;
inline constexpr std::uint64_t kDirections = 4;
inline constexpr std::uint64_t kKeyframe = 1, kBusy = 2, kOptimised = 4, kAllFlags = 7;

}  // namespace leviosim::traces
