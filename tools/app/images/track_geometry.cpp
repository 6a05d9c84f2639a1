#include "tools/app/images/track_geometry.h"

#include <algorithm>
#include <cmath>

#include "tools/app/images/feature_tracks.h"

namespace leviosim::tools {
namespace {

/// An observation with the camera's pose relative to that of the first one.
struct Ray {
  Eigen::Vector2d pixel;
  Eigen::Isometry3d T_here_first;
};

/// A point by direction (a, b, 1) and inverse depth in the first camera: also those far away.
using Point = Eigen::Vector3d;

class Triangulation {
 public:
  Triangulation(std::vector<Ray> rays, const traces::PinholeIntrinsics& camera)
      : rays_(std::move(rays)), camera_(camera) {}

  /// Times depth over the first depth.
  Eigen::Vector3d direction(const Ray& ray, const Point& point) const {
    return ray.T_here_first.linear() * Eigen::Vector3d(point.x(), point.y(), 1) +
           point.z() * ray.T_here_first.translation();
  }
  Eigen::Vector2d error(const Ray& ray, const Point& point) const {
    const Eigen::Vector3d d = direction(ray, point);
    return ray.pixel - Eigen::Vector2d(camera_.fx * d.x() / d.z() + camera_.cx,
                                       camera_.fy * d.y() / d.z() + camera_.cy);
  }
  bool in_front(const Point& point) const {
    return std::all_of(rays_.begin(), rays_.end(),
                       [&](const Ray& ray) { return direction(ray, point).z() > 0.01; });
  }
  Point solve(double inverse_depth) const {
    Point point((rays_[0].pixel.x() - camera_.cx) / camera_.fx,
                (rays_[0].pixel.y() - camera_.cy) / camera_.fy, inverse_depth);
    constexpr int kSteps = 15;
    for (int i = 0; i < kSteps && in_front(point); ++i) point += step(point);
    return point;
  }
  double cost(const Point& point) const {
    double sum = 0;
    for (const Ray& ray : rays_) sum += std::log1p(error(ray, point).squaredNorm());
    return sum;
  }
  const std::vector<Ray>& rays() const { return rays_; }

 private:
  /// Of Gauss and Newton, with the weights of the cost.
  Eigen::Vector3d step(const Point& point) const {
    Eigen::Matrix3d a = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Ray& ray : rays_) {
      const Eigen::Vector3d d = direction(ray, point);
      Eigen::Matrix<double, 2, 3> of_direction;
      of_direction << camera_.fx / d.z(), 0, -camera_.fx * d.x() / (d.z() * d.z()),  //
          0, camera_.fy / d.z(), -camera_.fy * d.y() / (d.z() * d.z());
      Eigen::Matrix3d of_point = ray.T_here_first.linear();
      of_point.col(2) = ray.T_here_first.translation();
      const Eigen::Matrix<double, 2, 3> jacobian = of_direction * of_point;
      const Eigen::Vector2d e = error(ray, point);
      const double weight = 1 / (1 + e.squaredNorm());
      a += weight * jacobian.transpose() * jacobian;
      b += weight * jacobian.transpose() * e;
    }
    return a.inverse() * b;
  }

  std::vector<Ray> rays_;
  traces::PinholeIntrinsics camera_;
};

std::vector<Ray> rays_of(const Track& track, const std::vector<Eigen::Isometry3d>& T_world_camera) {
  std::vector<Ray> rays;
  const Eigen::Isometry3d& first = T_world_camera[track.front().frame];
  for (const FeatureSeen& seen : track)
    rays.push_back({seen.pixel, T_world_camera[seen.frame].inverse() * first});
  return rays;
}

/// The largest angle between the first ray and another one.
double parallax(const Triangulation& of, const Point& point) {
  double most = 0;
  const Eigen::Vector3d first = of.direction(of.rays().front(), point).normalized();
  for (const Ray& ray : of.rays()) {
    const Eigen::Vector3d here =
        ray.T_here_first.linear().transpose() * of.direction(ray, point).normalized();
    most = std::max(most, std::atan2(first.cross(here).norm(), first.dot(here)));
  }
  return most;
}

}  // namespace

std::optional<TrackGeometry> track_geometry(const Track& track,
                                            const std::vector<Eigen::Isometry3d>& T_world_camera,
                                            const traces::PinholeIntrinsics& camera) {
  if (track.size() < kFewestObservations) return std::nullopt;
  const Triangulation triangulation(rays_of(track, T_world_camera), camera);
  std::optional<Point> best;
  for (const double inverse_depth : {0.02, 0.2, 2.0}) {
    const Point point = triangulation.solve(inverse_depth);
    if (triangulation.in_front(point) &&
        (!best || triangulation.cost(point) < triangulation.cost(*best)))
      best = point;
  }
  if (!best) return std::nullopt;
  TrackGeometry result;
  for (const Ray& ray : triangulation.rays())
    result.errors.push_back(triangulation.error(ray, *best));
  if (best->z() > 0 && parallax(triangulation, *best) >= kLeastParallax)
    for (const Ray& ray : triangulation.rays())
      result.depths.push_back(triangulation.direction(ray, *best).z() / best->z());
  return result;
}

}  // namespace leviosim::tools
