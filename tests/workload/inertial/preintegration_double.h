// A policy whose single precision is double precision: kernels instantiated with it can be compared
// with finite differences and closed forms far more sharply than float allows. Must be included
// before any kernel header, because kernels find work::sqrt and its like where they are defined.
#pragma once

#include <cmath>

#include "sim/work/policy.h"

namespace leviosim::work {

inline double sqrt(double x) { return std::sqrt(x); }
inline double abs(double x) { return std::fabs(x); }
inline double min(double a, double b) { return b < a ? b : a; }
inline double max(double a, double b) { return a < b ? b : a; }
inline std::int32_t to_i32(double x) { return static_cast<std::int32_t>(x); }

}  // namespace leviosim::work

#include "workload/math/trig.h"

namespace leviosim::vio {
namespace test {

struct DoublePolicy : work::Native {
  using F32 = double;
};

}  // namespace test

// The single-precision argument reduction does not carry over to double.
template <>
inline SinCos<test::DoublePolicy> sincos_of<test::DoublePolicy>(double x) {
  return {std::sin(x), std::cos(x)};
}
template <>
inline double atan2_of<test::DoublePolicy>(double y, double x) {
  return std::atan2(y, x);
}

}  // namespace leviosim::vio
