// The pinhole camera with radial-tangential ("plumb bob") distortion of EuRoC's sensor.yaml:
//   r² = x² + y²,  d = 1 + k1 r² + k2 r⁴
//   xd = x d + 2 p1 x y + p2 (r² + 2 x²),  yd = y d + p1 (r² + 2 y²) + 2 p2 x y
//   u = fx xd + cx,  v = fy yd + cy
// (Brown 1966, in the order of coefficients k1, k2, p1, p2 that the ASL format shares with OpenCV).
// and the fish-eye lens of TUM-VI, `equidistant` (Kannala and Brandt 2006, as Kalibr and OpenCV's
// fisheye have it):
//   θ = atan r,  θd = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸),  xd = x θd / r,  yd = y θd / r
// Pixel centres have whole-number coordinates. Left out: k3 and higher terms of the first, what a
// fish-eye sees at 90 degrees and beyond, rectified models, rolling shutter.
#pragma once

#include <Eigen/Geometry>

namespace leviosim::traces {

/// Rates of cameras and IMUs that are read.
inline constexpr double kLeastHz = 1e-3, kMostHz = 1e5;

enum class Lens { radial_tangential, equidistant };

struct CameraModel {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px] of the full-resolution image
  Lens lens = Lens::radial_tangential;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0;  ///< distortion coefficients
  double k3 = 0, k4 = 0;                  ///< of the equidistant lens, which has no p1 and p2
  int width = 0, height = 0;              ///< [px]
  /// Camera frame (x right, y down, z forward) to body frame: `T_BS` of sensor.yaml [m].
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  double rate_hz = 0;
  double time_shift_s = 0;  ///< to be added to the camera's stamps to get the IMU's
  /// The images are what image_preparation.h makes of a camera's, and are used as they are.
  bool prepared = false;

  /// Distorts a point on the plane z = 1.
  Eigen::Vector2d distort(const Eigen::Vector2d& normalized) const;

  /// Undoes distort() by Newton's method to 1e-12; exact within the image of EuRoC's lens. Throws
  /// InputError if there is no solution before the bend of the distortion polynomial, or if it lies
  /// at 90 degrees or beyond.
  Eigen::Vector2d undistort(const Eigen::Vector2d& distorted) const;

  /// The pixel that sees a point of the camera frame with z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& point_camera) const;

  /// The point on the plane z = 1 that a pixel sees.
  Eigen::Vector2d unproject(const Eigen::Vector2d& pixel) const;
};

/// A pinhole camera without distortion: what is left after undistortion and decimation.
struct PinholeIntrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]
  int width = 0, height = 0;              ///< [px]
};

}  // namespace leviosim::traces
