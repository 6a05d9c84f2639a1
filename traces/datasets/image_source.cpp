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
      mending_(data.faulty_pixels, full_size_),
      disturbance_(data.disturbance),
      preparation_(data.camera, size) {}

std::vector<std::uint8_t> ImageSource::read_full(std::size_t i) const {
  check(i < frames_.size(), "ImageSource: no such frame");
  const FrameRef& frame = frames_[i];
  const std::string row = base::at_line(frames_csv_, frame.line);
  std::string bytes;
  try {
    bytes = base::read_file(frame.path, base::InputKind::image);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", row, error.what()));
  }
  try {
    std::vector<std::uint8_t> picture = decode_gray(bytes, full_size_);
    mending_.apply(picture);
    return picture;
  } catch (const InputError& error) {
    throw InputError(fmt::format("image {} ({}): {}", frame.path.string(), row, error.what()));
  }
}

GrayImage ImageSource::read(std::size_t i) const {
  GrayImage result;
  result.width = intrinsics().width;
  result.height = intrinsics().height;
  result.pixels = preparation_.apply(read_full(i));
  result.t_ns = frames_[i].t_ns;
  disturb_picture(disturbance_, {result.t_ns, frames_.front().t_ns, frames_.back().t_ns},
                  result.width, result.pixels);
  return result;
}

}  // namespace leviosim::traces
