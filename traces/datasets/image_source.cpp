#include "traces/datasets/image_source.h"

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include <cstddef>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {

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
