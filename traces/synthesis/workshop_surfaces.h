// Surfaces as they are in workshops, which give a detector edges rather than corners: timber with
// long grain, knots and rows of nails that repeat; nets, whose meshes all look alike; dark cloth
// without contrast; metal; the sides of stacked pallets.
#pragma once

#include "traces/synthesis/surface_painter.h"
#include "traces/synthesis/texture.h"

namespace leviosim::traces {

/// The texture of a surface of style timber or later. A pure function of the spec.
Texture paint_material(const SurfaceSpec& spec);

}  // namespace leviosim::traces
