// Pixels of a camera that show nothing: stuck, hot or dead ones, alone or in rows and columns.
// Their values are replaced by those around them before anything else is done with a picture; a
// feature on them would stand still in the image whatever the camera does. Left out: what covers a
// part of the lens, and pixels that are merely noisier than others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "traces/datasets/image_file.h"

namespace leviosim::traces {

/// For each pixel, row by row: 0 if it is well. Empty: all are.
using PixelMask = std::vector<std::uint8_t>;

/// A grey picture of that size. Throws InputError, naming the file, if it is none, or if it leaves
/// fewer than half of the pixels.
PixelMask read_faulty_pixels(const std::filesystem::path& file, ImageSize size);

/// Each faulty pixel is given the mean of the nearest pixels in its row and column that are well.
class PixelMending {
 public:
  PixelMending() = default;
  PixelMending(const PixelMask& faulty, ImageSize size);

  /// @param picture  of the mask's size
  void apply(std::span<std::uint8_t> picture) const;

 private:
  struct Mended {
    std::size_t at = 0;
    std::array<std::size_t, 4> from{};
    std::size_t count = 0;  ///< of from
  };
  std::vector<Mended> mended_;
};

/// Finds them in pictures of a camera that moves.
class FaultyPixelSearch {
 public:
  explicit FaultyPixelSearch(ImageSize size);

  void add(std::span<const std::uint8_t> picture);

  /// A pixel that hardly changed, while pixels near it on both sides, in its row or in its column,
  /// did. Empty if there is none.
  PixelMask found() const;

 private:
  int range(std::size_t at) const { return most_[at] - least_[at]; }

  ImageSize size_;
  std::vector<std::uint8_t> least_, most_;  ///< of each pixel
};

}  // namespace leviosim::traces
