// Random numbers and RANSAC samples in counted scalars: a 32-bit linear feedback shift register and
// a partial Fisher-Yates shuffle (PARAMETERS.md#sampling).
//
// The register is a Galois LFSR over x^32 + x^22 + x^2 + x + 1, a primitive polynomial, so it
// visits all 2^32 - 1 non-zero states before it repeats. It advances one step per number.
// Neighbouring states are shifted copies of each other, which is harmless here: consecutive draws
// of a sample reduce them modulo n, n - 1, n - 2…, which are pairwise almost coprime. It is no
// generator for simulating noise.
//
// Left out: rejection of the modulo bias, which is below n / 2^32.
#pragma once

#include <cstdint>
#include <type_traits>

#include "sim/work/policy.h"

namespace leviosim::vio {

template <class P>
class Lfsr32 {
 public:
  using I32 = typename P::I32;
  using U32 = typename P::U32;

  /// Zero is the one state that the register never leaves, so it is replaced by one.
  explicit Lfsr32(std::uint32_t seed) : state_(seed == 0 ? 1u : seed) {}

  /// Advances one step and returns the new state, in 1 … 2^32 - 1.
  U32 next() {
    const U32 out = state_ & U32(1u);
    state_ = (state_ >> 1) ^ (-out & U32(kTaps));
    return state_;
  }
  /// A number in 0 … n - 1. n must be positive.
  I32 below(I32 n) { return I32(next() % U32(n)); }

 private:
  static constexpr std::uint32_t kTaps =
      0x80200003u;  // exponents 32, 22, 2, 1 as bits 31, 21, 1, 0

  U32 state_;
};

/// Writes 0, 1, 2 … into an index table: the state before the first draw.
template <class P, class Indices>
void number_consecutively(Indices indices) {
  using Index = std::remove_pointer_t<decltype(indices.data())>;
  for (int i : P::range(0, indices.size())) indices[i] = work::narrow<Index>(typename P::I32(i));
}

/// Draws `k` distinct numbers out of the first `n` entries of `indices` into `out[0 … k)`.
///
/// `indices` holds a permutation of the numbers to draw from. It is left permuted, so the next draw
/// starts from it without a new initialisation. Elements are 16-bit or 32-bit integers. n ≥ k.
template <class P, class Indices, class Sample>
void draw_sample(Lfsr32<P>& random, Indices indices, int n, int k, Sample out) {
  using I32 = typename P::I32;
  using Index = std::remove_pointer_t<decltype(indices.data())>;
  using Drawn = std::remove_pointer_t<decltype(out.data())>;
  for (int i : P::range(0, k)) {
    const I32 j = random.below(I32(n - i)) + I32(i);
    const I32 drawn = indices[j];
    const I32 displaced = indices[i];
    indices[i] = work::narrow<Index>(drawn);
    indices[j] = work::narrow<Index>(displaced);
    out[i] = work::narrow<Drawn>(drawn);
  }
}

}  // namespace leviosim::vio
