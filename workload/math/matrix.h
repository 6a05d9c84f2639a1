// Dense row-major matrices in memory: every element access is a counted load or store. Views do not
// own; storage comes from an arena (scratch of a core) so that it appears in the memory table.
#pragma once

#include "sim/work/arena.h"
#include "sim/work/policy.h"

namespace leviosim::vio {

/// rows × cols floats, element (r, c) at data[r * cols + c].
template <class P, class Element = typename P::F32>
class MatrixView {
 public:
  using Span = typename P::template Span<Element>;

  MatrixView() = default;
  MatrixView(Span data, int rows, int cols) : data_(data), rows_(rows), cols_(cols) {}
  /// A read-only view of the same matrix.
  operator MatrixView<P, const Element>() const { return {data_, rows_, cols_}; }

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  Span data() const { return data_; }
  decltype(auto) operator()(int r, int c) const { return data_[r * cols_ + c]; }
  /// Row or column known only from data: the address is computed.
  decltype(auto) operator()(work::I32 r, work::I32 c) const {
    return data_[work::I32(r * work::I32(cols_) + c)];
  }
  Span row(int r) const { return data_.subspan(r * cols_, cols_); }
  /// A row known only from data: its start is computed once, its elements are then a stream.
  Span row(work::I32 r) const {
    const work::I32 offset = r * work::I32(cols_) + work::I32(0);
    return data_.subspan(offset.v, cols_);
  }
  /// The matrix seen from column c on, so that (k, 0) walks down that column.
  MatrixView from_column(int c) const { return {data_.subspan(c, data_.size() - c), rows_, cols_}; }
  MatrixView from_column(work::I32 c) const {
    const work::I32 offset = c + work::I32(0);
    return from_column(offset.v);
  }

 private:
  Span data_;
  int rows_ = 0;
  int cols_ = 0;
};

template <class P>
using ConstMatrixView = MatrixView<P, const typename P::F32>;

/// An uninitialised rows × cols matrix in `arena`.
template <class P>
MatrixView<P> alloc_matrix(work::Arena& arena, std::string_view name, int rows, int cols) {
  using Span = typename P::template Span<typename P::F32>;
  return {arena.alloc<Span>(name, rows * cols), rows, cols};
}

template <class P>
void fill(MatrixView<P> a, typename P::F32 value) {
  for (int i : P::range(0, a.rows() * a.cols())) a.data()[i] = value;
}

template <class P>
void copy(MatrixView<P> to, ConstMatrixView<P> from) {
  for (int i : P::range(0, to.rows() * to.cols())) to.data()[i] = from.data()[i];
}

/// c = aᵀ b. c must not overlap a or b.
template <class P>
void multiply_transposed(MatrixView<P> c, ConstMatrixView<P> a, ConstMatrixView<P> b) {
  const typename P::Function function("multiply_transposed");
  for (int i : P::range(0, a.cols()))
    for (int j : P::range(0, b.cols())) {
      typename P::F32 sum = 0.0f;
      for (int k : P::range(0, a.rows())) sum += a(k, i) * b(k, j);
      c(i, j) = sum;
    }
}

}  // namespace leviosim::vio
