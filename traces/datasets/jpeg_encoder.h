// Grey pictures as JPEG files. Same pixels, same bytes, as far as the library's release is the
// same. Left out: colour.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace leviosim::traces {

/// @param pixels   [height x width], 8-bit grey, row by row
/// @param quality  from 1 to 100, as the library scales its tables
/// @throws std::bad_alloc
std::string jpeg_bytes(std::span<const std::uint8_t> pixels, int width, int height, int quality);

}  // namespace leviosim::traces
