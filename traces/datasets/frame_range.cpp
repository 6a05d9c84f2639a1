#include "traces/datasets/frame_range.h"

#include <fmt/core.h>

#include <charconv>

#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

bool parse_index(std::string_view text, std::size_t& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

FrameRange parse_frame_range(std::string_view text) {
  FrameRange range;
  const auto colon = text.find(':');
  if (colon == std::string_view::npos || !parse_index(text.substr(0, colon), range.begin) ||
      !parse_index(text.substr(colon + 1), range.end) || range.begin >= range.end)
    throw InputError(fmt::format(
        "frame range '{}': expected A:B with 0 <= A < B (B exclusive), e.g. 0:100", text));
  return range;
}

void check_frame_range(const FrameRange& range, std::size_t count, std::string_view what) {
  if (range.begin >= range.end || range.end > count)
    throw InputError(fmt::format("frame range {}:{}: {} has {} frames, so at most 0:{}",
                                 range.begin, range.end, what, count, count));
}

}  // namespace leviosim::traces
