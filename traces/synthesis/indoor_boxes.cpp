#include "traces/synthesis/indoor_boxes.h"

#include <array>

#include "traces/synthesis/surface_painter.h"

namespace leviosim::traces {

Box unpainted_box(const Eigen::Vector3f& min, const Eigen::Vector3f& max,
                  const std::array<float, 6>& light) {
  Box box;
  box.min = min;
  box.max = max;
  for (std::size_t face = 0; face < box.faces.size(); ++face) box.faces[face].light = light[face];
  return box;
}

void paint_face(Box& box, std::size_t face, SurfaceSpec spec) {
  const Eigen::Vector3d size = (box.max - box.min).cast<double>();
  const std::size_t axis = face / 2;
  spec.width_m = size[axis == 0 ? 1 : 0];
  spec.height_m = size[axis == 2 ? 1 : 2];
  box.faces[face].texture = paint_surface(spec);
  box.faces[face].texels_per_m = static_cast<float>(1 / spec.texel_m);
}

}  // namespace leviosim::traces
