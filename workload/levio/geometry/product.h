// The matrix product of the released program (PARAMETERS.md#linear-algebra): one function for all
// sizes. It learns sizes and transpositions at run time and tests the flag of an operand at every
// element, so every address is computed anew. Each result is stored after its dot product.
//
// Left out: everything that would make it faster.
#pragma once

#include <cstdint>

#include "workload/math/compilers.h"
#include "workload/math/matrix.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

/// A matrix as it enters a product: as it is, or transposed.
template <class P>
class Operand {
  using F = typename P::F32;
  using I32 = typename P::I32;

 public:
  Operand(ConstMatrixView<P> matrix, bool transposed)
      : data_(matrix.data()),
        rows_(static_cast<std::uint8_t>(matrix.rows())),
        cols_(static_cast<std::uint8_t>(matrix.cols())),
        transposed_(transposed ? 1 : 0) {}

  int rows() const { return transposed_ != 0 ? cols_ : rows_; }
  int cols() const { return transposed_ != 0 ? rows_ : cols_; }
  F at(int r, int c) const {
    if (I32(transposed_) != I32(0)) return data_[I32(c * cols_ + r)];
    return data_[I32(r * cols_ + c)];
  }

 private:
  typename P::template Span<const F> data_;
  std::uint8_t rows_, cols_, transposed_;
};

template <class P>
Operand<P> plain(ConstMatrixView<P> matrix) {
  return {matrix, false};
}
template <class P>
Operand<P> transposed(ConstMatrixView<P> matrix) {
  return {matrix, true};
}

/// c = a b, which must fit. c must not overlap a or b.
template <class P>
LEVIOSIM_HOST_INLINE LEVIOSIM_TARGET_CALL void product(const MatrixView<P>& c, const Operand<P>& a,
                                                       const Operand<P>& b) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_product");
  const Operand<P> left = a, right = b;
  const auto to = c.data();
  for (int i : P::byte_range(0, left.rows()))
    for (int j : P::byte_range(0, right.cols())) {
      F sum = 0.0f;
      for (int k : P::byte_range(0, left.cols())) sum += left.at(i, k) * right.at(k, j);
      to[I32(i * c.cols() + j)] = sum;
    }
}

/// y = A x, which must fit: a function of its own beside product(), as in the released program.
/// y must not overlap A or x.
template <class P>
LEVIOSIM_TARGET_CALL void product_with_vector(typename P::template Span<typename P::F32> y,
                                              const Operand<P>& a,
                                              typename P::template Span<const typename P::F32> x) {
  using F = typename P::F32;
  const typename P::Function function("levio_product_with_vector");
  const Operand<P> left = a;
  for (int i : P::byte_range(0, left.rows())) {
    F sum = 0.0f;
    for (int k : P::byte_range(0, left.cols())) sum += left.at(i, k) * x[k];
    y[i] = sum;
  }
}

}  // namespace leviosim::vio::levio
