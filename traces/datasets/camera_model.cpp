#include "traces/datasets/camera_model.h"

#include <fmt/core.h>

#include <Eigen/LU>

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

}  // namespace

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& normalized) const {
  const double x = normalized.x();
  const double y = normalized.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2;
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& distorted) const {
  constexpr int kMaxSteps = 50;
  constexpr double kTolerance = 1e-12;
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
  throw InputError(
      fmt::format("the distortion coefficients [{}, {}, {}, {}] cannot be inverted at the image "
                  "point ({}, {}) (normalised coordinates)",
                  k1, k2, p1, p2, distorted.x(), distorted.y()));
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& point_camera) const {
  const Eigen::Vector2d bent = distort(point_camera.head<2>() / point_camera.z());
  return {fx * bent.x() + cx, fy * bent.y() + cy};
}

Eigen::Vector2d CameraModel::unproject(const Eigen::Vector2d& pixel) const {
  return undistort({(pixel.x() - cx) / fx, (pixel.y() - cy) / fy});
}

}  // namespace leviosim::traces
