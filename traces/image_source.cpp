#include "traces/image_source.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>

#include "sim/check.h"
#include "sim/error.h"
#include "traces/csv.h"

namespace leviosim::traces {

ImageSource::ImageSource(const Dataset& data, ImageSize size)
    : frames_csv_(data.frames_csv),
      frames_(data.frames),
      full_size_(data.camera.width, data.camera.height),
      preparation_(data.camera, size) {}

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
  GrayImage result;
  result.width = intrinsics().width;
  result.height = intrinsics().height;
  result.t_ns = frames_[i].t_ns;
  result.pixels = preparation_.apply(decode(frames_[i]));
  return result;
}

}  // namespace leviosim::traces
