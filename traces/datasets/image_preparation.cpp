#include "traces/datasets/image_preparation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

constexpr int kStepBits = 5;
constexpr int kSteps = 1 << kStepBits;  ///< of a pixel

/// A position in steps; one that is far from any image is black, as is one that is no number.
int steps(double pixels) {
  constexpr double kFar = 1e6;
  return static_cast<int>(
      std::lrint(pixels > -kFar && pixels < kFar ? pixels * kSteps : -kFar * kSteps));
}

/// Where each pixel of the prepared image is in the camera's [1/32 px].
std::vector<Eigen::Vector2i> make_map(const CameraModel& camera, ImageSize size,
                                      const Decimation& decimation) {
  std::vector<Eigen::Vector2i> map;
  map.reserve(size.pixels());
  for (int j = 0; j < size.height; ++j) {
    for (int i = 0; i < size.width; ++i) {
      const double u = decimation.x0 + decimation.factor * i + decimation.shift;
      const double v = decimation.y0 + decimation.factor * j + decimation.shift;
      const Eigen::Vector2d bent =
          camera.distort({(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy});
      map.emplace_back(steps(camera.fx * bent.x() + camera.cx),
                       steps(camera.fy * bent.y() + camera.cy));
    }
  }
  return map;
}

/// Grey level between four pixels, black outside, as cv::remap() rounds it.
std::uint8_t interpolated(std::span<const std::uint8_t> image, ImageSize size,
                          const Eigen::Vector2i& at) {
  const int x = at.x() >> kStepBits;
  const int y = at.y() >> kStepBits;
  const int right = at.x() & (kSteps - 1);
  const int below = at.y() & (kSteps - 1);
  const auto pixel = [&](int column, int row) -> int {
    if (column < 0 || row < 0 || column >= size.width || row >= size.height) return 0;
    return image[static_cast<std::size_t>(row) * size.width + column];
  };
  const int above_level = (kSteps - right) * pixel(x, y) + right * pixel(x + 1, y);
  const int below_level = (kSteps - right) * pixel(x, y + 1) + right * pixel(x + 1, y + 1);
  constexpr int kHalf = kSteps * kSteps / 2;
  return static_cast<std::uint8_t>(((kSteps - below) * above_level + below * below_level + kHalf) >>
                                   (2 * kStepBits));
}

}  // namespace

Decimation make_decimation(const CameraModel& camera, ImageSize size) {
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
  const Decimation decimation = make_decimation(camera, size);
  intrinsics_ = decimated_intrinsics(camera, size, decimation);
  map_ = make_map(camera, size, decimation);
}

std::vector<std::uint8_t> ImagePreparation::apply(std::span<const std::uint8_t> full) const {
  const ImageSize size{camera_.width, camera_.height};
  check_equal(full.size(), size.pixels(), "ImagePreparation: the camera's image");
  std::vector<std::uint8_t> pixels(map_.size());
  for (std::size_t i = 0; i < map_.size(); ++i) pixels[i] = interpolated(full, size, map_[i]);
  return pixels;
}

std::vector<std::uint8_t> ImagePreparation::pixels_read() const {
  std::vector<std::uint8_t> read(static_cast<std::size_t>(camera_.width) * camera_.height, 0);
  const auto mark = [&](int x, int y) {
    if (x >= 0 && y >= 0 && x < camera_.width && y < camera_.height)
      read[static_cast<std::size_t>(y) * camera_.width + x] = 1;
  };
  for (const Eigen::Vector2i& at : map_)
    for (int corner = 0; corner < 4; ++corner)
      mark((at.x() >> kStepBits) + corner % 2, (at.y() >> kStepBits) + corner / 2);
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

ImageSource::ImageSource(const Dataset& data, ImageSize size)
    : frames_csv_(data.frames_csv),
      frames_(data.frames),
      full_size_{data.camera.width, data.camera.height},
      disturbance_(data.disturbance),
      preparation_(data.camera, size) {}

std::vector<std::uint8_t> ImageSource::decode(const FrameRef& frame) const {
  const std::string row = base::at_line(frames_csv_, frame.line);
  std::string bytes;
  try {
    bytes = base::read_file(frame.path, base::InputKind::image);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", row, error.what()));
  }
  try {
    return decode_gray(bytes, full_size_);
  } catch (const InputError& error) {
    throw InputError(fmt::format("image {} ({}): {}", frame.path.string(), row, error.what()));
  }
}

GrayImage ImageSource::read(std::size_t i) const {
  check(i < frames_.size(), "ImageSource::read: no such frame");
  GrayImage result;
  result.width = intrinsics().width;
  result.height = intrinsics().height;
  result.t_ns = frames_[i].t_ns;
  result.pixels = preparation_.apply(decode(frames_[i]));
  disturb_picture(disturbance_, {result.t_ns, frames_.front().t_ns, frames_.back().t_ns},
                  result.width, result.pixels);
  return result;
}

}  // namespace leviosim::traces
