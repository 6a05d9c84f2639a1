// Paints the surfaces of the synthetic world: a pattern that tells what the surface is made of,
// value noise in octaves from metres to centimetres, and things stuck to it at many scales (sheets
// of print, labels, checkers, discs), which give corners to a detector wherever the camera looks.
// The densities are chosen so that the 160x120 image has about as many keypoints as EuRoC's MH_01.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "traces/synthesis/world.h"

namespace leviosim::traces {

enum class SurfaceStyle {
  plaster,
  planks,
  bricks,
  crate,
  panels,
  timber,
  net,
  cloth,
  metal,
  stack
};

struct SurfaceSpec {
  SurfaceStyle style = SurfaceStyle::plaster;
  double width_m = 1;
  double height_m = 1;
  double texel_m = 0.004;  ///< edge length of a texel
  double tone = 120;       ///< mean grey level
  double scale = 1;        ///< enlarges every pattern, for surfaces that are seen from afar
  std::uint64_t seed = 0;
};

/// The texture of a surface; texel (0, 0) is at its origin. A pure function of the spec.
Texture paint_surface(const SurfaceSpec& spec);

// Surfaces as they are in workshops, which give a detector edges rather than corners: timber with
// long grain, knots and rows of nails that repeat; nets, whose meshes all look alike; dark cloth
// without contrast; metal; the sides of stacked pallets.

/// The texture of a surface of style timber or later. A pure function of the spec.
Texture paint_material(const SurfaceSpec& spec);

// Boxes of indoor scenes: how much light each side gets, and what is painted on it.

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
