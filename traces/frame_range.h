// A range of frames "A:B", B exclusive, as users write it on the command line.
#pragma once

#include <cstddef>
#include <string_view>

namespace leviosim::traces {

struct FrameRange {
  std::size_t begin = 0;
  std::size_t end = 0;  ///< exclusive
};

/// Throws InputError unless `text` is A:B with 0 <= A < B.
FrameRange parse_frame_range(std::string_view text);

}  // namespace leviosim::traces
