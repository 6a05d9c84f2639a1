// How features that were followed agree with the true poses: the point of each track is where the
// true rays meet best (robust least squares of reprojection errors, three unknowns); what is left
// is the error of the observations, and how deep the point lies.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <optional>
#include <vector>

#include "tools/app/images/feature_tracks.h"
#include "traces/datasets/camera_model.h"

namespace leviosim::tools {

struct TrackGeometry {
  std::vector<Eigen::Vector2d> errors;  ///< observed minus projected, of each observation [px]
  std::vector<double> depths;           ///< of each observation [m]; empty without parallax
};

/// Tracks of fewer observations fit whatever was observed.
inline constexpr std::size_t kFewestObservations = 4;
/// Of the rays of a track, without which it has no depth. [rad]
inline constexpr double kLeastParallax = 0.0175;

/// Nothing of a track that is too short or meets nowhere in front of its cameras.
/// @param T_world_camera  true poses by frame
std::optional<TrackGeometry> track_geometry(const Track& track,
                                            const std::vector<Eigen::Isometry3d>& T_world_camera,
                                            const traces::PinholeIntrinsics& camera);

}  // namespace leviosim::tools
