// The process networks that the event-kernel benchmark runs in several kernels, and their result.
//
// A run of a network is a fixed amount of work that starts when the network is told to and ends
// when nothing is left to do. A step is one wait that a process has got past. Each implementation
// counts its own steps and elapsed cycles; equal counts show that the networks have the same shape.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace leviosim::bench {

/// What one run did. One cycle is one tick here and 1 ns in SystemC.
struct RunResult {
  std::int64_t steps = 0;
  std::int64_t cycles = 0;
  friend bool operator==(const RunResult&, const RunResult&) = default;
};

inline constexpr std::size_t kDelays = 64;  // power of two
inline constexpr int kDelaysPerBarrier = 8;
inline constexpr int kBarrierLatency = 11;  // cycles
inline constexpr int kFifoDepth = 4;

/// Cycles a process waits at its n-th delay: 1..64, without pattern.
class DelayTable {
 public:
  explicit DelayTable(std::size_t process) {
    std::uint64_t state = 0x9e3779b97f4a7c15U * (process + 1);
    for (int& delay : delays_) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      delay = 1 + static_cast<int>(state >> 58);
    }
  }
  int operator[](std::size_t n) const { return delays_[n % kDelays]; }

 private:
  std::array<int, kDelays> delays_{};
};

}  // namespace leviosim::bench
