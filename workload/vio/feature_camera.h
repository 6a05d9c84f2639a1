// The camera for coordinates of features, which are whole numbers of 1/subpixel_steps px. Its
// inverse is a 3×3 constant of the program, which lies in L2 and is multiplied as a whole; the
// cluster reads its nine elements from there each time (PARAMETERS.md#memory). A controller has it
// in its own memory.
#pragma once

#include <array>

#include "workload/math/vec.h"

namespace leviosim::vio {

template <class P>
class FeatureCamera {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;

  /// @param camera  in px
  /// @param steps   per px
  FeatureCamera(const PinholeCamera& camera, int steps) : steps_(steps) {
    const auto per_px = static_cast<float>(steps);
    const PinholeCamera c{per_px * camera.fx, per_px * camera.fy, per_px * camera.cx,
                          per_px * camera.cy};
    const float inverse[] = {1.0f / c.fx,  0.0f, -c.cx / c.fx, 0.0f, 1.0f / c.fy,
                             -c.cy / c.fy, 0.0f, 0.0f,         1.0f};
    for (std::size_t i = 0; i < inverse_.size(); ++i) inverse_[i] = F(inverse[i]);
  }

  /// Image coordinates at depth 1.
  Vec2<P> normalised(I32 u, I32 v) const {
    const typename P::template L2Span<const F> k(inverse_.data(), 9);
    const Vec3<P> x{work::to_f32(u), work::to_f32(v), 1.0f};
    const Vec3<P> ray{F(k[0]) * x.x + F(k[1]) * x.y + F(k[2]) * x.z,
                      F(k[3]) * x.x + F(k[4]) * x.y + F(k[5]) * x.z,
                      F(k[6]) * x.x + F(k[7]) * x.y + F(k[8]) * x.z};
    return {ray.x, ray.y};
  }

  /// One coordinate in px.
  F pixel(I32 coordinate) const {
    if (steps_ == 1) return work::to_f32(coordinate);
    return work::to_f32(coordinate) * F(1.0f / static_cast<float>(steps_));
  }

 private:
  std::array<F, 9> inverse_;
  int steps_;
};

}  // namespace leviosim::vio
