#include "tools/app/flow/binned_frames.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/error.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_source.h"

namespace leviosim::tools {
namespace {

constexpr int kBinnedRows = 120;

int binning_for(int height) { return std::max(1, (height + kBinnedRows / 2) / kBinnedRows); }

}  // namespace

BinnedFrames::BinnedFrames(const traces::Dataset& data, int side)
    : source_(data, {data.camera.width, data.camera.height}),
      side_(side),
      binning_(binning_for(data.camera.height)) {
  const int width = data.camera.width / binning_;
  const int height = data.camera.height / binning_;
  if (std::min(width, height) < side)
    throw InputError(fmt::format(
        "{}: its images have {}x{} px after binning by {}; optical flow needs a window of {}x{}",
        data.frames_csv.string(), width, height, binning_, side, side));
}

double BinnedFrames::focal_length() const {
  return (source_.intrinsics().fx + source_.intrinsics().fy) / (2.0 * binning_);
}

std::vector<std::uint8_t> BinnedFrames::read(std::size_t frame) const {
  return binned_window(source_.read(frame), binning_, side_);
}

std::vector<std::uint8_t> binned_window(const traces::GrayImage& image, int binning, int side) {
  const int x0 = (image.width - side * binning) / 2;
  const int y0 = (image.height - side * binning) / 2;
  const int area = binning * binning;
  std::vector<std::uint8_t> window;
  window.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      int sum = 0;
      for (int j = 0; j < binning; ++j) {
        const int row = (y0 + y * binning + j) * image.width;
        for (int i = 0; i < binning; ++i)
          sum += image.pixels[static_cast<std::size_t>(row + x0 + x * binning + i)];
      }
      window.push_back(static_cast<std::uint8_t>((sum + area / 2) / area));
    }
  return window;
}

}  // namespace leviosim::tools
