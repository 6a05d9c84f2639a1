// Boxes of indoor scenes: how much light each side gets, and what is painted on it.
#pragma once

#include <array>
#include <cstddef>

#include "traces/synthesis/surface_painter.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {

/// Light on the faces -x, +x, -y, +y, -z, +z of an object under lamps that hang off-centre.
inline constexpr std::array<float, 6> kObjectLight{0.86f, 1.02f, 0.95f, 1.14f, 0.66f, 1.24f};
/// The faces of the room look inwards.
inline constexpr std::array<float, 6> kRoomLight{1.03f, 0.93f, 1.14f, 0.99f, 1.10f, 0.82f};

/// A box under light, not painted yet.
Box unpainted_box(const Eigen::Vector3f& min, const Eigen::Vector3f& max,
                  const std::array<float, 6>& light);

/// Paints one face of a box; `spec` says how, but for its width and height.
void paint_face(Box& box, std::size_t face, SurfaceSpec spec);

}  // namespace leviosim::traces
