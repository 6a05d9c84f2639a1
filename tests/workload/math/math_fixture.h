// What the tests of the linear algebra share: random numbers, and running a kernel under both
// policies.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <vector>

#include "tests/workload/math/eigen_conversions.h"
#include "workload/math/matrix.h"
#include "workload/math/vec.h"

namespace leviosim::vio::test {

/// SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) / 9007199254740992.0;
  }
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }

  Eigen::MatrixXd matrix(int rows, int cols) {
    Eigen::MatrixXd m(rows, cols);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < cols; ++c) m(r, c) = static_cast<float>(uniform(-1.0, 1.0));
    return m;
  }
  Eigen::MatrixXd symmetric(int n) {
    const Eigen::MatrixXd m = matrix(n, n);
    return (m + m.transpose()).unaryExpr([](double x) { return double(static_cast<float>(x)); });
  }
  Eigen::MatrixXd positive_definite(int n, double margin) {
    const Eigen::MatrixXd m = matrix(n, n);
    return m * m.transpose() + margin * Eigen::MatrixXd::Identity(n, n);
  }

 private:
  std::uint64_t state_;
};

template <class P>
MatrixView<P> place(work::Arena& arena, const Eigen::MatrixXd& m) {
  using F = typename P::F32;
  const auto view =
      alloc_matrix<P>(arena, "matrix", static_cast<int>(m.rows()), static_cast<int>(m.cols()));
  for (int r = 0; r < view.rows(); ++r)
    for (int c = 0; c < view.cols(); ++c) view(r, c) = F(static_cast<float>(m(r, c)));
  return view;
}

template <class P>
typename P::template Span<typename P::F32> place_vector(work::Arena& arena,
                                                        const Eigen::VectorXd& v) {
  return place<P>(arena, v).data();
}

template <class Span>
std::vector<float> values(Span span) {
  std::vector<float> out;
  for (int i = 0; i < span.size(); ++i) out.push_back(work::value(span.data()[i]));
  return out;
}

template <class P>
Eigen::MatrixXd to_eigen(MatrixView<P> view) {
  Eigen::MatrixXd m(view.rows(), view.cols());
  const std::vector<float> v = values(view.data());
  for (int r = 0; r < view.rows(); ++r)
    for (int c = 0; c < view.cols(); ++c) m(r, c) = v[r * view.cols() + c];
  return m;
}

template <class Span>
Eigen::VectorXd to_eigen_vector(Span span) {
  const std::vector<float> v = values(span);
  return Eigen::Map<const Eigen::VectorXf>(v.data(), span.size()).template cast<double>();
}

template <class P>
void append(std::vector<float>& out, const Mat3<P>& a) {
  for (int i = 0; i < 9; ++i) out.push_back(work::value(a.m[i / 3][i % 3]));
}

template <class P>
void append(std::vector<float>& out, const Vec3<P>& v) {
  for (const auto& x : {v.x, v.y, v.z}) out.push_back(work::value(x));
}

inline std::vector<std::uint32_t> bits(const std::vector<float>& v) {
  std::vector<std::uint32_t> out;
  for (const float x : v) out.push_back(std::bit_cast<std::uint32_t>(x));
  return out;
}

/// FNV-1a over the bits, for results that must be the same with every compiler.
inline std::uint64_t fingerprint(const std::vector<float>& v) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const std::uint32_t word : bits(v)) hash = (hash ^ word) * 0x100000001b3ull;
  return hash;
}

/// Runs `kernel.operator()<P>()`, which returns floats, under both policies and compares the bits.
/// Returns them.
template <class Kernel>
std::vector<float> same_bits_with_both_policies(Kernel kernel) {
  const std::vector<float> native = kernel.template operator()<work::Native>();
  work::take_tally();
  const std::vector<float> counted = kernel.template operator()<work::Counting>();
  EXPECT_FALSE(work::take_tally().empty());
  EXPECT_EQ(bits(native), bits(counted));
  return native;
}

}  // namespace leviosim::vio::test
