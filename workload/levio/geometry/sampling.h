// Samples for RANSAC as the released program draws them (PARAMETERS.md#sampling): one shift
// register for both estimators, which advances by one bit per number and is never seeded again.
//
// Neighbouring states are shifted copies of each other, so the draws of a sample depend on each
// other. It is no generator for simulating noise.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "sim/work/machine.h"
#include "sim/work/policy.h"

namespace leviosim::vio::levio {

/// A 32-bit Fibonacci register with taps 31, 6, 4, 2, 1 and 0; the new bit enters at the top.
template <class P>
class ShiftRegister {
 public:
  using I32 = typename P::I32;
  using U32 = typename P::U32;

  /// Zero is the one state that the register never leaves, so it is replaced by one.
  explicit ShiftRegister(std::uint32_t seed) : state_(seed == 0 ? 1u : seed) {}

  U32 next() {
    const U32 s = state_;
    const U32 bit = ((s >> 31) ^ (s >> 6) ^ (s >> 4) ^ (s >> 2) ^ (s >> 1) ^ s) & U32(1u);
    state_ = (s >> 1) | (bit << 31);
    return state_;
  }

  /// A number in 0 … n - 1, n positive. States above the largest multiple of n are passed over.
  I32 below(I32 n) {
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
    const U32 size(n);
    const U32 limit = U32(kMost) - U32(kMost) % size;
    U32 drawn = next();
    while (drawn >= limit) drawn = next();
    return I32(drawn % size);
  }

 private:
  U32 state_;
};

/// Draws `k` distinct numbers out of the n of `indices`, a permutation of 0 … n - 1, into `out`.
/// The permutation stays as the draw left it.
template <class P, class Indices>
void draw_sample(ShiftRegister<P>& random, Indices indices, int k, Indices out) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("levio_draw_sample");
  for (int i : P::range(0, k)) {
    const I32 j = random.below(I32(indices.size() - i)) + I32(i);
    const I32 drawn = indices[j];
    indices[j] = work::narrow<U16>(I32(indices[i]));
    indices[i] = work::narrow<U16>(drawn);
    out[i] = work::narrow<U16>(drawn);
  }
}

/// 0, 1, 2 …: the permutation before the first draw.
template <class P, class Indices>
void number_consecutively(Indices indices) {
  for (int i : P::range(0, indices.size()))
    indices[i] = work::narrow<typename P::U16>(typename P::I32(i));
}

/// How hypotheses are spread over forks. Samples are drawn and results compared in one order, so
/// that the best hypothesis does not depend on it.
class Batches {
  /// The released program's, which has a core for each.
  static constexpr int kReleased = 8;

 public:
  /// @param hypotheses  of all batches
  /// @param wanted      of a batch; 0: as many for each core of a team as make kReleased or more,
  ///                    since hypotheses differ in length and fewer cores would wait at more
  ///                    barriers; or one for each core, or for as many as have room
  /// @param each        local memory that a hypothesis takes, with the scratch of its core
  Batches(int hypotheses, int wanted, const work::Machine& machine, Bytes each)
      : hypotheses_(hypotheses),
        largest_(std::min(hypotheses, wanted > 0 ? wanted : with_room(machine, each))) {}

  int largest() const { return largest_; }
  int count() const { return (hypotheses_ + largest_ - 1) / largest_; }
  int size(int batch) const { return std::min(largest_, hypotheses_ - batch * largest_); }

 private:
  static int with_room(const work::Machine& machine, Bytes each) {
    // What is lent begins at words, and the best hypothesis takes some more.
    constexpr Bytes kBest(80), kPadding(4);
    const std::int64_t fit = (machine.local().free() - kBest).count() / (each + kPadding).count();
    const int cores = machine.cores();
    const int for_all = cores == 1 ? 1 : (kReleased + cores - 1) / cores * cores;
    return fit >= for_all ? for_all : static_cast<int>(std::clamp<std::int64_t>(fit, 1, cores));
  }

  int hypotheses_;
  int largest_;
};

}  // namespace leviosim::vio::levio
