// The random generator of everything synthetic: SplitMix64 (Steele, Lea and Flood, "Fast splittable
// pseudorandom number generators", 2014). Small, and the same on every host, unlike the
// distributions of the standard library. Streams for parts of a scene come from derive_seed(), so
// no part's numbers depend on the order in which the others are made.
#pragma once

#include <cmath>
#include <cstdint>

namespace leviosim::traces {

/// The output function of SplitMix64: a bijection that scatters neighbouring numbers.
constexpr std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// An independent seed for part `index` of what `seed` stands for.
constexpr std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t index) {
  return scramble(scramble(seed + 0x9E3779B97F4A7C15u) + (index + 1) * 0x9E3779B97F4A7C15u);
}

class Rng {
 public:
  constexpr explicit Rng(std::uint64_t seed) : state_(seed) {}

  constexpr std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15u;
    return scramble(state_);
  }
  /// In [0, 1), a multiple of 2^-53.
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [low, high), evenly spread over the orders of magnitude. Both above 0.
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform()); }
  /// In 0 ... count - 1. The bias of the remainder is below 1e-9 for the small counts used here.
  constexpr int below(int count) {
    return static_cast<int>(next() % static_cast<std::uint64_t>(count));
  }
  constexpr bool chance(double probability) { return uniform() < probability; }
  /// Standard normal, by Marsaglia's polar method.
  double normal() {
    for (;;) {
      const double a = uniform(-1, 1);
      const double b = uniform(-1, 1);
      const double s = a * a + b * b;
      if (s > 0 && s < 1) return a * std::sqrt(-2 * std::log(s) / s);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace leviosim::traces
