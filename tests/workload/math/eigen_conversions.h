// Small matrices and vectors of the workload as Eigen's, and back.
#pragma once

#include <Eigen/Geometry>
#include <utility>

#include "sim/work/policy.h"
#include "workload/math/vec.h"

namespace leviosim::vio::test {

/// Plain scalar of a policy: float, or double for DoublePolicy.
template <class P>
using Plain = decltype(work::value(std::declval<typename P::F32>()));

template <class P>
Eigen::Matrix3d to_eigen(const Mat3<P>& a) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = static_cast<double>(work::value(a.m[i / 3][i % 3]));
  return m;
}
template <class P>
Eigen::Vector3d to_eigen(const Vec3<P>& v) {
  return {static_cast<double>(work::value(v.x)), static_cast<double>(work::value(v.y)),
          static_cast<double>(work::value(v.z))};
}
template <class P>
Mat3<P> to_mat3(const Eigen::Matrix3d& m) {
  Mat3<P> a;
  for (int i = 0; i < 9; ++i) a.m[i / 3][i % 3] = static_cast<Plain<P>>(m(i / 3, i % 3));
  return a;
}
template <class P>
Vec3<P> to_vec3(const Eigen::Vector3d& v) {
  return {static_cast<Plain<P>>(v.x()), static_cast<Plain<P>>(v.y()), static_cast<Plain<P>>(v.z())};
}

}  // namespace leviosim::vio::test
