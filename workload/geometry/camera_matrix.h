// The camera matrix as the modelled library has it: a 3×3 constant of the program, which lies in L2
// and is multiplied as a whole; the cluster reads its nine elements from there each time
// (PARAMETERS.md#memory).
// A controller has it in its own memory.
#pragma once

#include <array>

#include "workload/math/vec.h"

namespace leviosim::vio {

template <class P>
class CameraMatrix {
  using F = typename P::F32;

 public:
  /// Camera frame [m] → homogeneous pixel.
  static CameraMatrix of(const PinholeCamera& c) {
    return CameraMatrix({c.fx, 0.0f, c.cx, 0.0f, c.fy, c.cy, 0.0f, 0.0f, 1.0f});
  }
  /// Homogeneous pixel → direction in the camera frame, with z = 1 for z = 1.
  static CameraMatrix inverse_of(const PinholeCamera& c) {
    return CameraMatrix(
        {1.0f / c.fx, 0.0f, -c.cx / c.fx, 0.0f, 1.0f / c.fy, -c.cy / c.fy, 0.0f, 0.0f, 1.0f});
  }

  Vec3<P> operator*(const Vec3<P>& x) const {
    const typename P::template L2Span<const F> k(elements_.data(), 9);
    return {F(k[0]) * x.x + F(k[1]) * x.y + F(k[2]) * x.z,
            F(k[3]) * x.x + F(k[4]) * x.y + F(k[5]) * x.z,
            F(k[6]) * x.x + F(k[7]) * x.y + F(k[8]) * x.z};
  }

 private:
  explicit CameraMatrix(const std::array<float, 9>& elements) {
    for (std::size_t i = 0; i < 9; ++i) elements_[i] = F(elements[i]);
  }

  std::array<F, 9> elements_;
};

/// Difference in pixels between where K puts a point of the camera frame (z > 0) and where it was
/// seen.
template <class P>
Vec2<P> reprojection_difference(const CameraMatrix<P>& K, const Vec3<P>& in_camera,
                                typename P::F32 seen_u, typename P::F32 seen_v) {
  using F = typename P::F32;
  const Vec3<P> image = K * in_camera;
  const F inverse = F(1.0f) / image.z;
  return {image.x * inverse - seen_u, image.y * inverse - seen_v};
}

}  // namespace leviosim::vio
