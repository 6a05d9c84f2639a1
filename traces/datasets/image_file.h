// Grey pictures from the bytes of a PNG or JPEG file, by libraries that print nothing and say what
// is wrong. The head of the file is checked before memory is asked for. And PNG files of pictures.
// Colours become grey by the luma of Rec. 601, of 16 bits the upper 8 are kept (as TUM-VI is
// usually read), transparency is passed over. Left out: CMYK and other formats, which are refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::traces {

struct ImageSize {
  int width = 160;
  int height = 120;

  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
  bool operator==(const ImageSize&) const = default;
};

/// The picture, 8-bit grey, row by row without padding; PNG files of 1, 2 and 4 bits are scaled to
/// 8. Throws InputError, without the file's name, for anything else, another size than `expected`,
/// and files that are damaged or cut off.
std::vector<std::uint8_t> decode_gray(std::string_view bytes, ImageSize expected);

/// What the head of the file says. Throws InputError as decode_gray() does.
ImageSize image_size(std::string_view bytes);

/// The bytes of a PNG file of a picture, 8-bit grey, row by row and at least a row; the same pixels
/// give the same bytes. Compressed lightly, for pictures with noise.
std::string encode_png(ImageSize size, std::span<const std::uint8_t> pixels);

}  // namespace leviosim::traces
