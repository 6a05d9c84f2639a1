#include "traces/image_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sim/check.h"
#include "sim/error.h"
#include "traces/csv.h"

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

ImageSource::ImageSource(const Dataset& data, ImageSize size)
    : frames_csv_(data.frames_csv),
      frames_(data.frames),
      full_size_(data.camera.width, data.camera.height) {
  const Decimation decimation = make_decimation(data.camera, size);
  intrinsics_ = decimated_intrinsics(data.camera, size, decimation);
  map_whole_.create(size.height, size.width, CV_16SC2);
  map_fraction_.create(size.height, size.width, CV_16UC1);
  fill_maps(data.camera, decimation, map_whole_, map_fraction_);
}

cv::Mat ImageSource::decode(const FrameRef& frame) const {
  const auto fail = [&](const std::string& message) {
    throw InputError(fmt::format("image {} ({}): {}", frame.path.string(),
                                 at_line(frames_csv_, frame.line), message));
  };
  cv::Mat image;
  try {
    image = cv::imread(frame.path.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    fail(fmt::format("cannot be read as an image: {}", e.err));
  }
  if (image.empty()) fail("cannot be read as an image");
  if (image.type() != CV_8UC1)
    fail(fmt::format("has {} channel{} of {} bits; expected 8-bit grey (1 channel)",
                     image.channels(), image.channels() == 1 ? "" : "s", image.elemSize1() * 8));
  if (image.size() != full_size_)
    fail(fmt::format("is {}x{}; sensor.yaml says {}x{}", image.cols, image.rows, full_size_.width,
                     full_size_.height));
  return image;
}

GrayImage ImageSource::read(std::size_t i) const {
  check(i < frames_.size(), "ImageSource::read: no such frame");
  const cv::Mat full = decode(frames_[i]);
  GrayImage result;
  result.width = intrinsics_.width;
  result.height = intrinsics_.height;
  result.t_ns = frames_[i].t_ns;
  result.pixels.resize(static_cast<std::size_t>(result.width) * result.height);
  cv::Mat output(result.height, result.width, CV_8UC1, result.pixels.data());
  cv::remap(full, output, map_whole_, map_fraction_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return result;
}

}  // namespace leviosim::traces
