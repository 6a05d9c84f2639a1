// How a body moves: the pose and its exact derivatives at any time, the source of ground truth and
// of what an ideal IMU feels.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>

namespace leviosim::traces {

/// At one time. World frame: z up. Body frame: that of the IMU.
struct MotionState {
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< in the world [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          ///< in the world [m/s²]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      ///< in the body [rad/s]
};

class Motion {
 public:
  virtual ~Motion() = default;
  /// The state at a time in seconds; any time is valid.
  virtual MotionState at(double t_s) const = 0;
};

/// A value and its first two derivatives with respect to time.
struct Derivatives {
  double value = 0;
  double first = 0;
  double second = 0;
};

/// A hand-held flight through the middle of make_room(). Position and yaw, pitch, roll are each a
/// sum of two sines of a path parameter s(t) that rests at 0 until `kRestS`, then gets going within
/// `kStartS` along a polynomial with three continuous derivatives, and from then on runs with time.
/// All derivatives are analytic. The phases follow from the seed. By construction |x| <= 1.15 m,
/// |y| <= 0.8 m, 1.2 m <= z <= 2.0 m; typically 0.6 m/s and 30 °/s, at most 1.31 m/s and 60 °/s.
///
/// Body axes are EuRoC's: x up, y right, z forward when yaw, pitch and roll are zero, so that the
/// camera of euroc_cam0() looks ahead along the world's x axis.
class HandHeldFlight : public Motion {
 public:
  static constexpr double kRestS = 1.0;
  static constexpr double kStartS = 2.0;

  explicit HandHeldFlight(std::uint64_t seed);
  MotionState at(double t_s) const override;

 private:
  struct Sine {
    double amplitude, angular_frequency, phase;
  };
  struct Channel {
    double offset;
    std::array<Sine, 2> sines;
  };
  static Derivatives path_parameter(double t_s);
  static Derivatives evaluate(const Channel& channel, const Derivatives& s);

  std::array<Channel, 6> channels_;  // x, y, z [m], yaw, pitch, roll [rad]
};

}  // namespace leviosim::traces
