#include "traces/datasets/camera_model.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

/// The derivative of CameraModel::distort.
Eigen::Matrix2d distortion_jacobian(const CameraModel& camera, const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + camera.k1 * r2 + camera.k2 * r2 * r2;
  const double slope = 2 * camera.k1 + 4 * camera.k2 * r2;  // d(radial)/dx = slope x
  const double cross = slope * x * y + 2 * camera.p1 * x + 2 * camera.p2 * y;
  Eigen::Matrix2d jacobian;
  jacobian(0, 0) = radial + slope * x * x + 2 * camera.p1 * y + 6 * camera.p2 * x;
  jacobian(0, 1) = cross;
  jacobian(1, 0) = cross;
  jacobian(1, 1) = radial + slope * y * y + 6 * camera.p1 * y + 2 * camera.p2 * x;
  return jacobian;
}

constexpr int kMaxSteps = 50;
constexpr double kTolerance = 1e-12;

/// θd / θ as a polynomial in θ², and θd of the equidistant lens.
double bent_angle(const CameraModel& c, double theta) {
  const double t = theta * theta;
  return theta * (1 + t * (c.k1 + t * (c.k2 + t * (c.k3 + t * c.k4))));
}
double bent_angle_slope(const CameraModel& c, double theta) {
  const double t = theta * theta;
  return 1 + t * (3 * c.k1 + t * (5 * c.k2 + t * (7 * c.k3 + t * 9 * c.k4)));
}

[[noreturn]] void fail_to_invert(const CameraModel& c, const Eigen::Vector2d& distorted) {
  const bool radial = c.lens == Lens::radial_tangential;
  throw InputError(fmt::format(
      "the distortion coefficients [{}, {}, {}, {}] cannot be inverted at the image "
      "point ({}, {}) (normalised coordinates)",
      c.k1, c.k2, radial ? c.p1 : c.k3, radial ? c.p2 : c.k4, distorted.x(), distorted.y()));
}

Eigen::Vector2d undo_equidistant(const CameraModel& c, const Eigen::Vector2d& distorted) {
  constexpr double kWidest = 1.57;  // just below 90 degrees
  const double wanted = distorted.norm();
  if (wanted == 0) return distorted;
  double theta = std::min(wanted, kWidest);
  for (int step = 0; step < kMaxSteps; ++step) {
    const double error = bent_angle(c, theta) - wanted;
    const double slope = bent_angle_slope(c, theta);
    if (slope <= 0 || theta < 0 || theta > kWidest) break;
    if (std::abs(error) < kTolerance) return distorted * (std::tan(theta) / wanted);
    theta -= error / slope;
  }
  fail_to_invert(c, distorted);
}

}  // namespace

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& normalized) const {
  if (lens == Lens::equidistant) {
    const double r = normalized.norm();
    return r == 0 ? normalized
                  : Eigen::Vector2d(normalized * (bent_angle(*this, std::atan(r)) / r));
  }
  const double x = normalized.x();
  const double y = normalized.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2;
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& distorted) const {
  if (lens == Lens::equidistant) return undo_equidistant(*this, distorted);
  Eigen::Vector2d point = distorted;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector2d error = distort(point) - distorted;
    const Eigen::Matrix2d jacobian = distortion_jacobian(*this, point);
    if (error.squaredNorm() < kTolerance * kTolerance) {
      // Beyond the bend of the polynomial there are further solutions, which no lens has.
      const bool same_side = point.dot(distorted) >= 0;
      if (!same_side || jacobian.determinant() <= 0) break;
      return point;
    }
    point -= jacobian.inverse() * error;
  }
  fail_to_invert(*this, distorted);
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& point_camera) const {
  const Eigen::Vector2d bent = distort(point_camera.head<2>() / point_camera.z());
  return {fx * bent.x() + cx, fy * bent.y() + cy};
}

Eigen::Vector2d CameraModel::unproject(const Eigen::Vector2d& pixel) const {
  return undistort({(pixel.x() - cx) / fx, (pixel.y() - cy) / fy});
}

}  // namespace leviosim::traces
