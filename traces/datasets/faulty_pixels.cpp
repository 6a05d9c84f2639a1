#include "traces/datasets/faulty_pixels.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"

namespace leviosim::traces {
namespace {

struct PixelStep {
  int x, y;
};
constexpr std::array<PixelStep, 4> kAround{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

/// The first place from (x, y) on, itself left out, for which `is` holds, at most `farthest` steps
/// away; absent beyond the picture.
template <class Is>
std::optional<std::size_t> nearest_pixel(ImageSize size, int x, int y, PixelStep step, int farthest,
                                         const Is& is) {
  for (int n = 0; n < farthest; ++n) {
    x += step.x;
    y += step.y;
    if (x < 0 || y < 0 || x >= size.width || y >= size.height) return std::nullopt;
    const std::size_t at = static_cast<std::size_t>(y) * size.width + x;
    if (is(at)) return at;
  }
  return std::nullopt;
}

}  // namespace

PixelMask read_faulty_pixels(const std::filesystem::path& file, ImageSize size) {
  const std::string bytes = base::read_file(file, base::InputKind::image);
  PixelMask mask;
  try {
    mask = decode_gray(bytes, size);
  } catch (const InputError& error) {
    throw InputError(fmt::format("mask of faulty pixels {}: {}", file.string(), error.what()));
  }
  const auto well = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 0));
  if (2 * well < mask.size())
    throw InputError(fmt::format(
        "mask of faulty pixels {}: {} of {} pixels are well; expected half of them or more, which "
        "are black in it",
        file.string(), well, mask.size()));
  return mask;
}

PixelMending::PixelMending(const PixelMask& faulty, ImageSize size) {
  if (faulty.empty()) return;
  check_equal(faulty.size(), size.pixels(), "PixelMending: the mask");
  const int farthest = std::max(size.width, size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      Mended pixel{static_cast<std::size_t>(y) * size.width + x};
      if (faulty[pixel.at] == 0) continue;
      const auto is_well = [&](std::size_t at) { return faulty[at] == 0; };
      for (const PixelStep step : kAround)
        if (const auto from = nearest_pixel(size, x, y, step, farthest, is_well))
          pixel.from[pixel.count++] = *from;
      if (pixel.count > 0) mended_.push_back(pixel);
    }
}

void PixelMending::apply(std::span<std::uint8_t> picture) const {
  for (const Mended& pixel : mended_) {
    std::size_t sum = pixel.count / 2;
    for (std::size_t i = 0; i < pixel.count; ++i) sum += picture[pixel.from[i]];
    picture[pixel.at] = static_cast<std::uint8_t>(sum / pixel.count);
  }
}

FaultyPixelSearch::FaultyPixelSearch(ImageSize size)
    : size_(size), least_(size.pixels(), 255), most_(size.pixels(), 0) {}

void FaultyPixelSearch::add(std::span<const std::uint8_t> picture) {
  check_equal(picture.size(), size_.pixels(), "FaultyPixelSearch: the picture");
  for (std::size_t i = 0; i < picture.size(); ++i) {
    least_[i] = std::min(least_[i], picture[i]);
    most_[i] = std::max(most_[i], picture[i]);
  }
}

PixelMask FaultyPixelSearch::found() const {
  constexpr int kHardly = 2, kLively = 16;  // ranges in grey levels
  constexpr int kNear = 3;                  // pixels
  PixelMask mask(size_.pixels(), 0);
  bool any = false;
  const auto is_lively = [&](std::size_t at) { return range(at) >= kLively; };
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * size_.width + x;
      if (range(at) > kHardly) continue;
      const auto lives = [&](std::size_t step) {
        return nearest_pixel(size_, x, y, kAround[step], kNear, is_lively).has_value();
      };
      if (!(lives(0) && lives(1)) && !(lives(2) && lives(3))) continue;
      mask[at] = 255;
      any = true;
    }
  return any ? mask : PixelMask();
}

}  // namespace leviosim::traces
