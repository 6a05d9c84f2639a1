// The matrix product of the released program (PARAMETERS.md#linear-algebra): one function for all
// sizes. It learns sizes and transpositions at run time and tests the flag of an operand at every
// element, so every address is computed anew. Each result is stored after its dot product.
//
// Left out: everything that would make it faster.
#pragma once

#include "workload/math/matrix.h"
#include "workload/math/target_call.h"

namespace leviosim::vio::levio {

/// A matrix as it enters a product: as it is, or transposed.
template <class P>
class Operand {
  using F = typename P::F32;
  using I32 = typename P::I32;

 public:
  Operand(ConstMatrixView<P> matrix, bool transposed)
      : matrix_(matrix), transposed_(transposed ? 1 : 0) {}

  int rows() const { return work::value(transposed_) != 0 ? matrix_.cols() : matrix_.rows(); }
  int cols() const { return work::value(transposed_) != 0 ? matrix_.rows() : matrix_.cols(); }
  F at(int r, int c) const {
    if (transposed_ != I32(0)) return matrix_.data()[I32(c * matrix_.cols() + r)];
    return matrix_.data()[I32(r * matrix_.cols() + c)];
  }

 private:
  ConstMatrixView<P> matrix_;
  I32 transposed_;
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
LEVIOSIM_TARGET_CALL void product(MatrixView<P> c, const Operand<P>& a, const Operand<P>& b) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_product");
  const auto to = c.data();
  for (int i : P::range(0, a.rows()))
    for (int j : P::range(0, b.cols())) {
      F sum = 0.0f;
      for (int k : P::range(0, a.cols())) sum += a.at(i, k) * b.at(k, j);
      to[I32(i * c.cols() + j)] = sum;
    }
}

}  // namespace leviosim::vio::levio
