// What the head of a file of a picture says, and how a damaged one is refused: for the readers of
// each format. Left out: the formats (image_file.cpp, jpeg_file.h).
#pragma once

#include <fmt/core.h>

#include <string_view>

#include "sim/base/error.h"

namespace leviosim::traces {

struct ImageHeader {
  unsigned width = 0;   ///< [pixels]
  unsigned height = 0;  ///< [pixels]
  bool colour = false;  ///< decoded to red, green, blue, 8 bits each; else to 8-bit grey
};

[[noreturn]] inline void refuse_damaged_image(std::string_view format, std::string_view reason) {
  throw InputError(fmt::format("cannot be read as an image: damaged {}: {}", format, reason));
}

}  // namespace leviosim::traces
