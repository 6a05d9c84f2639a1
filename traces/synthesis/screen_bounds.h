// Where a box can appear in a picture: the rectangle around its projection on the plane z = 1 of a
// camera, which tells what parts of a picture need not look at it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "traces/synthesis/world.h"

namespace leviosim::traces {

/// In normalised image coordinates x / z, y / z.
using ScreenBounds = Eigen::AlignedBox2f;

/// Bounds of what is visible of the box in front of the camera, empty if all of it lies behind.
/// What is nearer than 1 mm to the camera's plane counts as behind.
ScreenBounds screen_bounds(const Box& box, const Eigen::Isometry3f& T_camera_world);

}  // namespace leviosim::traces
