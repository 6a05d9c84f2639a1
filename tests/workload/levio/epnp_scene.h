// Random views of a cloud of points, with known pose and known outliers. Only IEEE-exact operations
// make the coordinates (noise apart), so that a scene has the same bits on every host.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/workload/math/math_fixture.h"
#include "tests/workload/test_camera.h"
#include "workload/levio/geometry/epnp_ransac.h"

namespace leviosim::vio::test {

struct SceneOptions {
  int points = 60;
  double outliers = 0.0;      ///< part of the matches, which come first
  double noise_px = 0.0;      ///< standard deviation per axis
  bool whole_pixels = false;  ///< measurements rounded, as those of keypoints
  double nearest_m = 1.5;
  double farthest_m = 6.0;
};

struct Scene {
  std::vector<float> points, pixels;
  int n = 0;
  int outliers = 0;
  Eigen::Matrix3d R;  ///< R_camera_world
  Eigen::Vector3d t;
};

inline double normal_variate(Random& random) {
  const double u = 1.0 - random.uniform(0.0, 1.0);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * random.uniform(0.0, 1.0));
}

inline Eigen::Matrix3d random_rotation(Random& random) {
  double q[4];
  double norm2 = 0.0;
  do {
    norm2 = 0.0;
    for (double& c : q) {
      c = random.uniform(-1.0, 1.0);
      norm2 += c * c;
    }
  } while (norm2 > 1.0 || norm2 < 0.1);
  const double s = 2.0 / norm2;
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  Eigen::Matrix3d R;
  R << 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),  //
      s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),   //
      s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y);
  return R;
}

inline Scene make_scene(Random& random, const SceneOptions& options) {
  Scene scene;
  scene.n = options.points;
  scene.outliers = static_cast<int>(options.outliers * options.points);
  scene.R = random_rotation(random);
  for (int c = 0; c < 3; ++c) scene.t(c) = random.uniform(-3.0, 3.0);
  for (int i = 0; i < scene.n; ++i) {
    double u = random.uniform(16.0, 144.0), v = random.uniform(16.0, 104.0);
    const double z = random.uniform(options.nearest_m, options.farthest_m);
    const double x = (u - double(kCamera.cx)) / double(kCamera.fx) * z;
    const double y = (v - double(kCamera.cy)) / double(kCamera.fy) * z;
    const double d[3] = {x - scene.t(0), y - scene.t(1), z - scene.t(2)};
    for (int c = 0; c < 3; ++c)
      scene.points.push_back(
          static_cast<float>(scene.R(0, c) * d[0] + scene.R(1, c) * d[1] + scene.R(2, c) * d[2]));
    if (i < scene.outliers) {
      u = random.uniform(16.0, 144.0);
      v = random.uniform(16.0, 104.0);
    }
    if (options.noise_px > 0.0) {
      u += options.noise_px * normal_variate(random);
      v += options.noise_px * normal_variate(random);
    }
    if (options.whole_pixels) {
      u = std::floor(u + 0.5);
      v = std::floor(v + 0.5);
    }
    scene.pixels.push_back(static_cast<float>(u));
    scene.pixels.push_back(static_cast<float>(v));
  }
  return scene;
}

/// The scene as the kernels read it. It must outlive the input.
template <class P>
levio::LandmarkMatches<P> input_of(const Scene& scene) {
  using F = typename P::F32;
  const auto* points = reinterpret_cast<const F*>(scene.points.data());
  const auto* pixels = reinterpret_cast<const F*>(scene.pixels.data());
  return {{points, 3 * scene.n}, {pixels, 2 * scene.n}, scene.n};
}

struct PoseError {
  double position_m;
  double angle_deg;
};

inline PoseError error_against(const Scene& scene, const Eigen::Matrix3d& R,
                               const Eigen::Vector3d& t) {
  const Eigen::Matrix3d difference = R * scene.R.transpose();
  const double sine =
      Eigen::Vector3d(difference(2, 1) - difference(1, 2), difference(0, 2) - difference(2, 0),
                      difference(1, 0) - difference(0, 1))
          .norm();
  return {(R.transpose() * t - scene.R.transpose() * scene.t).norm(),
          std::atan2(sine, difference.trace() - 1.0) * 57.29577951308232};
}

template <class P>
PoseError error_against(const Scene& scene, const Pose<P>& pose) {
  return error_against(scene, to_eigen(pose.R), to_eigen(pose.t));
}

}  // namespace leviosim::vio::test
