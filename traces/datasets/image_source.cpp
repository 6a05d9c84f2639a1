#include "traces/datasets/image_source.h"

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

/// All that decides what is made of a picture, besides the picture.
std::string name_of(const CameraModel& c, const PixelMask& mask, ImageSize size) {
  const std::string camera =
      fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}x{} {} to {}x{}", c.fx, c.fy, c.cx, c.cy,
                  static_cast<int>(c.lens), c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.width, c.height,
                  c.prepared, size.width, size.height);
  return base::sha256_of(camera + '\0' + std::string(mask.begin(), mask.end()));
}

}  // namespace

ImageSource::ImageSource(const Dataset& data, ImageSize size, std::shared_ptr<PictureMemory> memory)
    : frames_csv_(data.frames_csv),
      frames_(data.frames),
      full_size_{data.camera.width, data.camera.height},
      mending_(data.faulty_pixels, full_size_),
      disturbance_(data.disturbance),
      preparation_(data.camera, size),
      memory_(std::move(memory)) {
  if (memory_) preparation_name_ = name_of(data.camera, data.faulty_pixels, size);
}

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

std::vector<std::uint8_t> ImageSource::prepared(std::size_t i) const {
  if (!memory_) return preparation_.apply(read_full(i));
  check(i < frames_.size(), "ImageSource: no such frame");
  const std::string name = preparation_name_ + frames_[i].path.string();
  if (std::optional<std::vector<std::uint8_t>> kept = memory_->find(name)) return std::move(*kept);
  std::vector<std::uint8_t> pixels = preparation_.apply(read_full(i));
  memory_->keep(name, pixels);
  return pixels;
}

GrayImage ImageSource::read(std::size_t i) const {
  GrayImage result;
  result.width = intrinsics().width;
  result.height = intrinsics().height;
  result.pixels = prepared(i);
  result.t_ns = frames_[i].t_ns;
  disturb_picture(disturbance_, {result.t_ns, frames_.front().t_ns, frames_.back().t_ns},
                  result.width, result.pixels);
  return result;
}

}  // namespace leviosim::traces
