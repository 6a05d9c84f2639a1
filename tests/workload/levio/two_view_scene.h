// Synthetic pairs of views with known geometry for the tests of the kernels of two views, and the
// way to hand them to kernels of either policy.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/work/policy.h"
#include "tests/workload/math/eigen_conversions.h"
#include "tests/workload/test_camera.h"
#include "workload/levio/geometry/eight_point.h"

namespace leviosim::vio::test {

/// SplitMix64, scaled to real numbers. Callers draw one number per statement or in braces: the
/// order of evaluation of function arguments differs between compilers.
class HostRandom {
 public:
  explicit HostRandom(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1.0p-53;
  }
  Eigen::Vector3d direction() {
    Eigen::Vector3d v;
    do v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    while (v.norm() > 1 || v.norm() < 0.1);
    return v.normalized();
  }

  Eigen::Matrix3d rotation(double max_angle) {
    const double angle = uniform(0, max_angle);
    return Eigen::AngleAxisd(angle, direction()).toRotationMatrix();
  }

 private:
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

inline constexpr double kWidth = 160;
inline constexpr double kHeight = 120;

struct TwoViewSceneOptions {
  int matches = 100;
  double outliers = 0;   ///< share of the matches with an arbitrary point in b
  bool rounded = false;  ///< pixels rounded to integers, as feature positions are
  double baseline_m[2] = {0.05, 0.2};
  double depth_m[2] = {1.5, 6.0};
  double max_rotation_rad = 0.1;
};

struct TwoViewScene {
  Eigen::Matrix3d R_b_a;
  Eigen::Vector3d t_b_a;  ///< metres
  std::vector<Eigen::Vector3d> points_a;
  std::vector<Eigen::Vector2d> seen_a, seen_b;  ///< normalised image coordinates
  std::vector<bool> outlier;
  int n = 0;

  Eigen::Matrix3d essential() const {
    const Eigen::Vector3d t = t_b_a.normalized();
    Eigen::Matrix3d cross;
    cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
    return cross * R_b_a;
  }
};

inline Eigen::Vector2d to_pixel(const Eigen::Vector3d& x) {
  return {kCamera.fx * x.x() / x.z() + kCamera.cx, kCamera.fy * x.y() / x.z() + kCamera.cy};
}
inline Eigen::Vector2d to_normalised(const Eigen::Vector2d& pixel) {
  return {(pixel.x() - kCamera.cx) / kCamera.fx, (pixel.y() - kCamera.cy) / kCamera.fy};
}
inline bool in_image(const Eigen::Vector2d& pixel) {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < kWidth && pixel.y() < kHeight;
}

inline TwoViewScene make_two_view_scene(std::uint64_t seed, const TwoViewSceneOptions& options) {
  HostRandom random(seed);
  TwoViewScene scene;
  scene.R_b_a = random.rotation(options.max_rotation_rad);
  const double baseline = random.uniform(options.baseline_m[0], options.baseline_m[1]);
  scene.t_b_a = random.direction() * baseline;
  const auto arbitrary_pixel = [&] {
    return Eigen::Vector2d{random.uniform(0, kWidth), random.uniform(0, kHeight)};
  };
  const auto measured = [&](Eigen::Vector2d pixel) {
    if (options.rounded) pixel = pixel.array().round();
    return to_normalised(pixel);
  };
  while (scene.n < options.matches) {
    const Eigen::Vector2d in_a = arbitrary_pixel();
    const double depth = random.uniform(options.depth_m[0], options.depth_m[1]);
    const Eigen::Vector3d point = depth * Eigen::Vector3d(to_normalised(in_a).homogeneous());
    const Eigen::Vector3d point_b = scene.R_b_a * point + scene.t_b_a;
    if (point_b.z() < 0.3 || !in_image(to_pixel(point_b))) continue;
    const bool outlier = random.uniform(0, 1) < options.outliers;
    scene.points_a.push_back(point);
    scene.outlier.push_back(outlier);
    scene.seen_a.push_back(measured(in_a));
    scene.seen_b.push_back(measured(outlier ? arbitrary_pixel() : to_pixel(point_b)));
    ++scene.n;
  }
  return scene;
}

/// The matches of a scene as storage of policy P.
template <class P>
class MatchStorage {
 public:
  using F = typename P::F32;

  explicit MatchStorage(const TwoViewScene& scene) : n_(scene.n) {
    for (const Eigen::Vector2d& x : scene.seen_a) append(a_, x);
    for (const Eigen::Vector2d& x : scene.seen_b) append(b_, x);
  }
  levio::TwoViewMatches<P> view() const { return {{a_.data(), 2 * n_}, {b_.data(), 2 * n_}, n_}; }

 private:
  static void append(std::vector<F>& to, const Eigen::Vector2d& x) {
    to.push_back(F(static_cast<float>(x.x())));
    to.push_back(F(static_cast<float>(x.y())));
  }
  int n_;
  std::vector<F> a_, b_;
};

template <class P>
Vec2<P> to_vec2(const Eigen::Vector2d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y())};
}
template <class P>
Pose<P> to_pose(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  return {to_mat3<P>(R), to_vec3<P>(t)};
}

/// Largest difference between two matrices that are known up to scale and sign.
inline double difference_up_to_scale(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d x = a.normalized(), y = b.normalized();
  return std::min((x - y).cwiseAbs().maxCoeff(), (x + y).cwiseAbs().maxCoeff());
}
inline double degrees_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle() * 180 / M_PI;
}
inline double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

}  // namespace leviosim::vio::test
