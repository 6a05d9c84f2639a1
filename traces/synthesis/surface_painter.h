// Paints the surfaces of the synthetic world: a pattern that tells what the surface is made of,
// value noise in octaves from metres to centimetres, and things stuck to it at many scales (sheets
// of print, labels, checkers, discs), which give corners to a detector wherever the camera looks.
// The densities are chosen so that the 160x120 image has about as many keypoints as EuRoC's MH_01.
#pragma once

#include <cstdint>

#include "traces/synthesis/texture.h"

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

}  // namespace leviosim::traces
