// The camera for coordinates of features, which are whole numbers of 1/subpixel_steps px.
#pragma once

#include "workload/geometry/camera_matrix.h"

namespace leviosim::vio {

template <class P>
class FeatureCamera {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;

  /// @param camera  in px
  /// @param steps   per px
  FeatureCamera(const PinholeCamera& camera, int steps)
      : inverse_(CameraMatrix<P>::inverse_of(finer(camera, static_cast<float>(steps)))),
        steps_(steps) {}

  /// Image coordinates at depth 1.
  Vec2<P> normalised(I32 u, I32 v) const {
    const Vec3<P> x = inverse_ * Vec3<P>{work::to_f32(u), work::to_f32(v), 1.0f};
    return {x.x, x.y};
  }

  /// One coordinate in px.
  F pixel(I32 coordinate) const {
    if (steps_ == 1) return work::to_f32(coordinate);
    return work::to_f32(coordinate) * F(1.0f / static_cast<float>(steps_));
  }

 private:
  static PinholeCamera finer(const PinholeCamera& c, float steps) {
    return {steps * c.fx, steps * c.fy, steps * c.cx, steps * c.cy};
  }

  CameraMatrix<P> inverse_;
  int steps_;
};

}  // namespace leviosim::vio
