#include "traces/datasets/camera_model.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "tests/traces/test_folder.h"
#include "traces/datasets/euroc_sensors.h"

namespace leviosim::traces {
namespace {

TEST(CameraModel, ProjectsLikeOpenCv) {
  const CameraModel camera = euroc_cam0();
  const cv::Mat matrix =
      (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Mat coefficients =
      (cv::Mat_<double>(4, 1) << camera.k1, camera.k2, camera.p1, camera.p2);
  const std::vector<cv::Point3d> points{{0.1, -0.2, 1}, {1.5, 0.7, 2.5}, {-2, 1, 3}, {0, 0, 4}};
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, coefficients, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d pixel = camera.project({points[i].x, points[i].y, points[i].z});
    EXPECT_NEAR(pixel.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(pixel.y(), pixels[i].y, 1e-9);
  }
}

TEST(CameraModel, UnprojectInvertsProjectOverTheWholeImage) {
  const CameraModel camera = euroc_cam0();
  for (int y = -1; y <= camera.height; y += 13) {
    for (int x = -1; x <= camera.width; x += 17) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector2d point = camera.unproject(pixel);
      const Eigen::Vector2d again = camera.project({3 * point.x(), 3 * point.y(), 3});
      ASSERT_LT((again - pixel).norm(), 1e-8) << x << " " << y;
    }
  }
}

/// The lens of TUM-VI's cam0.
CameraModel tum_vi_cam0() {
  CameraModel camera;
  camera.lens = Lens::equidistant;
  camera.fx = 190.978;
  camera.fy = 190.973;
  camera.cx = 254.932;
  camera.cy = 256.897;
  camera.k1 = 0.00348238940225;
  camera.k2 = 0.000715034845216;
  camera.k3 = -0.00205323614187;
  camera.k4 = 0.000202936735918;
  camera.width = camera.height = 512;
  return camera;
}

TEST(CameraModel, AnEquidistantLensProjectsLikeOpenCv) {
  const CameraModel camera = tum_vi_cam0();
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Vec4d coefficients(camera.k1, camera.k2, camera.k3, camera.k4);
  const std::vector<cv::Point3d> points{{0.1, -0.2, 1}, {1.5, 0.7, 0.5}, {-2, 1, 3}, {0, 0, 4}};
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), matrix, coefficients);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d pixel = camera.project({points[i].x, points[i].y, points[i].z});
    EXPECT_NEAR(pixel.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(pixel.y(), pixels[i].y, 1e-9);
  }
}

TEST(CameraModel, UnprojectInvertsAnEquidistantLensWithin85Degrees) {
  const CameraModel camera = tum_vi_cam0();
  int pixels = 0;
  for (int y = 0; y < camera.height; y += 13) {
    for (int x = 0; x < camera.width; x += 17) {
      const Eigen::Vector2d pixel(x, y);
      if ((pixel - Eigen::Vector2d(camera.cx, camera.cy)).norm() > 280) continue;
      const Eigen::Vector2d point = camera.unproject(pixel);
      const Eigen::Vector2d again = camera.project({3 * point.x(), 3 * point.y(), 3});
      ASSERT_LT((again - pixel).norm(), 1e-8) << x << " " << y;
      ++pixels;
    }
  }
  EXPECT_GT(pixels, 1000);
  testing::expect_input_error([&] { camera.unproject({0, 0}); }, {"cannot be inverted"});  // 113°
}

TEST(CameraModel, DistortionThatCannotBeInvertedIsRefused) {
  CameraModel camera = euroc_cam0();
  camera.k1 = -1;  // r (1 - r²) never exceeds 0.385
  camera.k2 = camera.p1 = camera.p2 = 0;
  testing::expect_input_error([&] { camera.undistort({0.9, 0.1}); }, {"cannot be inverted", "-1"});
}

}  // namespace
}  // namespace leviosim::traces
