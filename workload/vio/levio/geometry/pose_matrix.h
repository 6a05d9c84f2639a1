// Poses as 4×4 matrices in memory, and points moved by the generic product
// (PARAMETERS.md#memory): what the released program does wherever a point changes frames.
#pragma once

#include "workload/math/vec.h"
#include "workload/vio/levio/algebra/product.h"

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

/// The first three elements of T (x, y, z, 1).
template <class P>
Vec3<P> moved(ConstMatrixView<P> T, const Vec3<P>& point) {
  using F = typename P::F32;
  typename P::template Array<F, 4> x, y;
  x[0] = point.x;
  x[1] = point.y;
  x[2] = point.z;
  x[3] = 1.0f;
  const MatrixView<P> result(y, 4, 1);
  product<P>(result, plain<P>(T), plain<P>(MatrixView<P>(x, 4, 1)));
  return {F(y[0]), F(y[1]), F(y[2])};
}

}  // namespace leviosim::vio::levio
