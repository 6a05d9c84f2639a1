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

/// Throws InputError, which names `what`, unless the range selects from its `count` frames.
void check_frame_range(const FrameRange& range, std::size_t count, std::string_view what);

}  // namespace leviosim::traces
