// Runs the library routines of emulated arithmetic over ordinary operands: no zeros, NaNs,
// infinities or denormals, and the trigonometry of a C library over the angles of Jacobi rotations.
// Compiled for cores without (rv32im) and with single precision in hardware; where the hardware
// computes, no routine runs.
#include <cstdint>
#include <cstring>

#include "tools/rv32/marked_functions.h"

extern "C" {
float sinf(float);
float cosf(float);
float atan2f(float, float);
}

namespace {

constexpr int kOperands = 64;

/// Of either sign, from 1/64 to 64, with all bits of the significand.
template <class Real, class Bits, int kExponentBits, int kBits>
Real operand(std::uint32_t& state) {
  Bits bits = 0;
  for (int i = 0; i < kBits / 16; ++i) {
    state = state * 1664525u + 1013904223u;
    bits = static_cast<Bits>(bits << 16) | (state >> 16);
  }
  constexpr int kFractionBits = kBits - 1 - kExponentBits;
  constexpr Bits kBias = (Bits{1} << (kExponentBits - 1)) - 1;
  const Bits exponent = kBias - 6 + (state >> 8) % 12;
  bits &= ~(((Bits{1} << kExponentBits) - 1) << kFractionBits);
  bits |= exponent << kFractionBits;
  Real x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

volatile float singles[kOperands];
volatile double doubles[kOperands];
volatile int integers[kOperands];
volatile float single_result;
volatile double double_result;
volatile int integer_result;

template <class Real>
[[gnu::noinline]] void exercise(const volatile Real* in, volatile Real& result) {
  for (int i = 0; i < kOperands; ++i) {
    const Real a = in[i], b = in[(i * 7 + 3) % kOperands];
    result = a + b;
    result = a - b;
    result = a * b;
    result = a / b;
    integer_result = a < b;
    integer_result = a <= b;
    integer_result = a > b;
    integer_result = a == b;
    integer_result = static_cast<int>(a);
    result = static_cast<Real>(integers[i]);
  }
}

/// The angles by which Jacobi rotates.
[[gnu::noinline]] void exercise_trigonometry(const volatile float* in) {
  for (int i = 0; i < kOperands; ++i) {
    const float angle = 0.5f * atan2f(in[i], in[(i * 7 + 3) % kOperands]);
    single_result = cosf(angle);
    single_result = sinf(angle);
  }
}

/// The double precision of a Jacobi rotation (workload/levio/geometry/svd.h): what the
/// workload's calls of it are.
[[gnu::noinline]] void exercise_rotations(const volatile float* in) {
  for (int i = 0; i < kOperands; ++i) {
    const float app = in[i], aqq = in[(i * 7 + 3) % kOperands], apq = in[(i * 5 + 1) % kOperands];
    const float angle = 0.5f * atan2f(2.0f * apq, aqq - app);
    const float c = cosf(angle), s = sinf(angle);
    const double wide_s = s;
    const double mixed = (wide_s + wide_s) * c * apq;
    single_result = static_cast<float>((c * c * app) - mixed + (s * s * aqq));
    single_result = static_cast<float>((s * s * app) + mixed + (c * c * aqq));
  }
}

/// As C libraries without a square root instruction do it: one bit of the root per step.
[[gnu::noinline, gnu::used]] float digit_by_digit_sqrtf(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  const int exponent = static_cast<int>(bits >> 23) - 127;
  std::uint32_t rest = (bits & 0x7fffffu) | 0x800000u;
  if (exponent & 1) rest <<= 1;
  std::uint32_t root = 0, sum = 0;
  rest <<= 1;
  for (std::uint32_t digit = 0x1000000u; digit != 0; digit >>= 1) {
    const std::uint32_t trial = sum + digit;
    if (trial <= rest) {
      sum = trial + digit;
      rest -= trial;
      root += digit;
    }
    rest <<= 1;
  }
  if (rest != 0) root += root & 1;
  const std::uint32_t result =
      (root >> 1) + 0x3f000000u + (static_cast<std::uint32_t>(exponent >> 1) << 23);
  std::memcpy(&x, &result, sizeof x);
  return x;
}

}  // namespace

int main() {
  std::uint32_t state = 1;
  for (int i = 0; i < kOperands; ++i) {
    singles[i] = operand<float, std::uint32_t, 8, 32>(state);
    doubles[i] = operand<double, std::uint64_t, 11, 64>(state);
    integers[i] = static_cast<int>(state >> 8) - (1 << 23);
  }
  {
    const leviosim::work::FunctionScope<false> scene("scene: rotations");
    exercise_rotations(singles);
  }
  const leviosim::work::FunctionScope<false> scene("scene: library");
  exercise<float>(singles, single_result);
  exercise<double>(doubles, double_result);
  exercise_trigonometry(singles);
  for (int i = 0; i < kOperands; ++i) {
    double_result = static_cast<double>(static_cast<float>(singles[i]));
    single_result = static_cast<float>(static_cast<double>(doubles[i]));
    const float x = singles[i];
    single_result = digit_by_digit_sqrtf(x < 0 ? -x : x);
  }
  return 0;
}
