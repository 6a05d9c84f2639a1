#include "traces/datasets/image_preparation.h"

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

/// An image that others own, as OpenCV takes it.
cv::Mat view_of(std::span<const std::uint8_t> pixels, int width, int height) {
  return {height, width, CV_8UC1, const_cast<std::uint8_t*>(pixels.data())};
}

/// A position rounded to what interpolation distinguishes, 1/32 px; one that is far from any image,
/// or no number, is black. Single precision is exact to that.
float rounded(double pixels) {
  constexpr double kFar = 1e6, kSteps = cv::INTER_TAB_SIZE;
  return static_cast<float>(pixels > -kFar && pixels < kFar ? std::rint(pixels * kSteps) / kSteps
                                                            : -kFar);
}

/// Where each pixel of the prepared image is in the camera's: column, row.
cv::Mat make_positions(const CameraModel& camera, ImageSize size, const Decimation& decimation) {
  cv::Mat positions(size.height, size.width, CV_32FC2);
  for (int j = 0; j < size.height; ++j) {
    for (int i = 0; i < size.width; ++i) {
      const double u = decimation.x0 + decimation.factor * i + decimation.shift;
      const double v = decimation.y0 + decimation.factor * j + decimation.shift;
      const Eigen::Vector2d bent =
          camera.distort({(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy});
      positions.at<cv::Vec2f>(j, i) = {rounded(camera.fx * bent.x() + camera.cx),
                                       rounded(camera.fy * bent.y() + camera.cy)};
    }
  }
  return positions;
}

}  // namespace

Decimation make_decimation(const CameraModel& camera, ImageSize size) {
  constexpr int kWidest = std::numeric_limits<std::int16_t>::max() - 1;  // of OpenCV's maps
  if (std::max(camera.width, camera.height) > kWidest)
    throw InputError(fmt::format("images of {}x{}: expected at most {} pixels in a row or column",
                                 camera.width, camera.height, kWidest));
  if (camera.prepared && (size.width != camera.width || size.height != camera.height))
    throw InputError(
        fmt::format("image size {}x{}: the images of this flight are already undistorted and "
                    "decimated to {}x{}, the only size they can be used at",
                    size.width, size.height, camera.width, camera.height));
  if (size.width <= 0 || size.height <= 0 || size.width > camera.width ||
      size.height > camera.height)
    throw InputError(fmt::format("image size {}x{}: expected between 1x1 and the camera's {}x{}",
                                 size.width, size.height, camera.width, camera.height));
  Decimation result;
  result.factor = std::min(camera.width / size.width, camera.height / size.height);
  result.x0 = (camera.width - size.width * result.factor) / 2;
  result.y0 = (camera.height - size.height * result.factor) / 2;
  result.shift = result.factor > 1 ? 1 : 0;
  return result;
}

PinholeIntrinsics decimated_intrinsics(const CameraModel& camera, ImageSize size,
                                       const Decimation& decimation) {
  const double k = decimation.factor;
  PinholeIntrinsics result;
  result.fx = camera.fx / k;
  result.fy = camera.fy / k;
  result.cx = (camera.cx - decimation.x0) / k;
  result.cy = (camera.cy - decimation.y0) / k;
  result.width = size.width;
  result.height = size.height;
  return result;
}

ImagePreparation::ImagePreparation(const CameraModel& camera, ImageSize size) : camera_(camera) {
  // An image is the least piece of work that threads share: OpenCV starts none of its own.
  [[maybe_unused]] static const bool alone = (cv::setNumThreads(1), true);
  const Decimation decimation = make_decimation(camera, size);
  intrinsics_ = decimated_intrinsics(camera, size, decimation);
  corners_.resize(size.pixels());
  fractions_.resize(size.pixels());
  cv::Mat corners(size.height, size.width, CV_16SC2, corners_.data());
  cv::Mat fractions(size.height, size.width, CV_16UC1, fractions_.data());
  cv::convertMaps(make_positions(camera, size, decimation), cv::noArray(), corners, fractions,
                  CV_16SC2);
}

std::vector<std::uint8_t> ImagePreparation::apply(std::span<const std::uint8_t> full) const {
  const ImageSize size{camera_.width, camera_.height};
  check_equal(full.size(), size.pixels(), "ImagePreparation: the camera's image");
  std::vector<std::uint8_t> pixels(corners_.size());
  const int width = intrinsics_.width, height = intrinsics_.height;
  cv::Mat prepared = view_of(pixels, width, height);
  const cv::Mat corners(height, width, CV_16SC2, const_cast<Corner*>(corners_.data()));
  const cv::Mat fractions(height, width, CV_16UC1, const_cast<std::uint16_t*>(fractions_.data()));
  cv::remap(view_of(full, size.width, size.height), prepared, corners, fractions, cv::INTER_LINEAR,
            cv::BORDER_CONSTANT);
  return pixels;
}

std::vector<std::uint8_t> ImagePreparation::pixels_read() const {
  std::vector<std::uint8_t> read(static_cast<std::size_t>(camera_.width) * camera_.height, 0);
  const auto mark = [&](int x, int y) {
    if (x >= 0 && y >= 0 && x < camera_.width && y < camera_.height)
      read[static_cast<std::size_t>(y) * camera_.width + x] = 1;
  };
  for (const Corner& at : corners_)
    for (int corner = 0; corner < 4; ++corner) mark(at[0] + corner % 2, at[1] + corner / 2);
  return read;
}

CameraModel ImagePreparation::prepared_camera() const {
  CameraModel camera = camera_;
  camera.fx = intrinsics_.fx;
  camera.fy = intrinsics_.fy;
  camera.cx = intrinsics_.cx;
  camera.cy = intrinsics_.cy;
  camera.lens = Lens::radial_tangential;
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = camera.k3 = camera.k4 = 0;
  camera.width = intrinsics_.width;
  camera.height = intrinsics_.height;
  camera.prepared = true;
  return camera;
}

}  // namespace leviosim::traces
