#include "traces/datasets/image_preparation.h"

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstddef>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

/// Fills the fixed-point maps of cv::remap: positions in units of 1/32 px.
void fill_maps(const CameraModel& camera, const Decimation& decimation, cv::Mat& whole,
               cv::Mat& fraction) {
  constexpr int kSteps = cv::INTER_TAB_SIZE;
  for (int j = 0; j < whole.rows; ++j) {
    for (int i = 0; i < whole.cols; ++i) {
      const double u = decimation.x0 + decimation.factor * i + decimation.shift;
      const double v = decimation.y0 + decimation.factor * j + decimation.shift;
      const Eigen::Vector2d bent =
          camera.distort({(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy});
      const int x = cv::saturate_cast<int>((camera.fx * bent.x() + camera.cx) * kSteps);
      const int y = cv::saturate_cast<int>((camera.fy * bent.y() + camera.cy) * kSteps);
      whole.at<cv::Vec2s>(j, i) = {cv::saturate_cast<short>(x >> cv::INTER_BITS),
                                   cv::saturate_cast<short>(y >> cv::INTER_BITS)};
      fraction.at<ushort>(j, i) =
          static_cast<ushort>((y & (kSteps - 1)) * kSteps + (x & (kSteps - 1)));
    }
  }
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
  map_whole_.create(size.height, size.width, CV_16SC2);
  map_fraction_.create(size.height, size.width, CV_16UC1);
  fill_maps(camera, decimation, map_whole_, map_fraction_);
}

std::vector<std::uint8_t> ImagePreparation::apply(const cv::Mat& full) const {
  check(full.type() == CV_8UC1 && full.cols == camera_.width && full.rows == camera_.height,
        "ImagePreparation: the camera's image");
  std::vector<std::uint8_t> pixels(map_whole_.total());
  cv::Mat output(map_whole_.size(), CV_8UC1, pixels.data());
  cv::remap(full, output, map_whole_, map_fraction_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return pixels;
}

std::vector<std::uint8_t> ImagePreparation::pixels_read() const {
  std::vector<std::uint8_t> read(static_cast<std::size_t>(camera_.width) * camera_.height, 0);
  const auto mark = [&](int x, int y) {
    if (x >= 0 && y >= 0 && x < camera_.width && y < camera_.height)
      read[static_cast<std::size_t>(y) * camera_.width + x] = 1;
  };
  for (auto it = map_whole_.begin<cv::Vec2s>(); it != map_whole_.end<cv::Vec2s>(); ++it)
    for (int corner = 0; corner < 4; ++corner) mark((*it)[0] + corner % 2, (*it)[1] + corner / 2);
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
      full_size_(data.camera.width, data.camera.height),
      disturbance_(data.disturbance),
      preparation_(data.camera, size) {}

cv::Mat ImageSource::decode(const FrameRef& frame) const {
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
