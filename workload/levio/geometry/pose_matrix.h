// Poses as 4×4 matrices in memory, and points moved by the generic product
// (PARAMETERS.md#memory): what the released program does wherever a point changes frames.
#pragma once

#include "workload/levio/geometry/product.h"
#include "workload/math/vec.h"

namespace leviosim::vio::levio {

template <class P>
void store_pose(MatrixView<P> to, const Pose<P>& pose) {
  const typename P::F32 t[3] = {pose.t.x, pose.t.y, pose.t.z};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) to(r, c) = pose.R.m[r][c];
    to(r, 3) = t[r];
    to(3, r) = 0.0f;
  }
  to(3, 3) = 1.0f;
}

template <class P>
Pose<P> load_pose(ConstMatrixView<P> from) {
  using F = typename P::F32;
  Pose<P> pose;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) pose.R.m[r][c] = F(from(r, c));
  pose.t = {F(from(0, 3)), F(from(1, 3)), F(from(2, 3))};
  return pose;
}

/// Moves points by one pose, whose operand is made once for all of them.
template <class P>
class PointMover {
  using F = typename P::F32;

 public:
  explicit PointMover(ConstMatrixView<P> T) : T_(plain<P>(T)) {}
  PointMover(const PointMover&) = delete;
  PointMover& operator=(const PointMover&) = delete;

  /// The first three elements of T (x, y, z, 1).
  Vec3<P> operator()(const Vec3<P>& point) {
    x_[0] = point.x;
    x_[1] = point.y;
    x_[2] = point.z;
    x_[3] = 1.0f;
    product_with_vector<P>(y_, T_, x_);
    return {F(y_[0]), F(y_[1]), F(y_[2])};
  }

 private:
  typename P::template Array<F, 4> x_, y_;
  Operand<P> T_;
};

}  // namespace leviosim::vio::levio
