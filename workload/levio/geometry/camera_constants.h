// The camera as the released program has it: four constants that lie in L2 and are read from there
// at every use (PARAMETERS.md#memory).
#pragma once

#include <array>

#include "workload/math/vec.h"

namespace leviosim::vio::levio {

template <class P>
class CameraConstants {
  using F = typename P::F32;

 public:
  explicit CameraConstants(const PinholeCamera& camera)
      : values_{F(camera.fx), F(camera.fy), F(camera.cx), F(camera.cy)} {}

  F fx() const { return in_l2()[0]; }
  F fy() const { return in_l2()[1]; }
  F cx() const { return in_l2()[2]; }
  F cy() const { return in_l2()[3]; }

  /// Image coordinates at depth 1 of a pixel: two divisions.
  Vec2<P> normalised(F u, F v) const { return {F(u - cx()) / fx(), F(v - cy()) / fy()}; }

 private:
  typename P::template L2Span<const F> in_l2() const { return {values_.data(), 4}; }

  std::array<F, 4> values_;
};

}  // namespace leviosim::vio::levio
