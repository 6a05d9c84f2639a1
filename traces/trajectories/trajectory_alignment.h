// Closed-form alignment of two point sets (Umeyama 1991; Horn 1987 for the rotation), the step that
// takes away the freedom a trajectory estimate has by nature before it is compared with the truth.
#pragma once

#include <Eigen/Geometry>

#include <string_view>
#include <vector>

#include "sim/base/error.h"

namespace leviosim::traces {

/// Trajectories that no error can be given for, though they are read and matched: an estimator that
/// diverged leaves such a one.
class NotComparable : public InputError {
 public:
  using InputError::InputError;
};

enum class Alignment {
  none,    ///< compared as they are
  se3,     ///< rotation and translation
  sim3,    ///< rotation, translation and scale: monocular without IMU
  posyaw,  ///< translation and rotation about z: visual-inertial, gravity is observable
};

/// "none", "SE3", "Sim3", "PosYaw".
std::string_view name_of(Alignment alignment);

/// The alignment called "none", "se3", "sim3" or "posyaw". Throws InputError for others.
Alignment parse_alignment(std::string_view name);

/// x -> scale * rotation * x + translation.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return scale * (rotation * point) + translation;
  }
};

/// The transform of the given kind that brings `from` closest to `to` (least squares). If the
/// points leave a rotation open (all on a line), any best one is returned. Throws InputError for
/// fewer points than needed (none: 0, posyaw: 2, se3 and sim3: 3), and NotComparable for sim3 if
/// all points of `from` coincide, which leaves the scale open, and if squares of positions
/// overflow.
Similarity align_points(const std::vector<Eigen::Vector3d>& from,
                        const std::vector<Eigen::Vector3d>& to, Alignment alignment);

}  // namespace leviosim::traces
