// The timeline of a run as a file for Perfetto's page (README.md says what its tracks mean). Same
// events, same bytes.
#pragma once

#include <cstddef>
#include <string>

#include "tools/app/timeline/frame_events.h"

namespace leviosim::tools {

/// What the slices of a frame take at most: if they are more, short steps are joined. With the
/// rest, such as counters and the optimiser, a frame stays below 50 kB.
inline constexpr std::size_t kMostBytesOfFrame = 47'000;

/// @param run  that the events are of
/// @param most_bytes_of_frame  0: all steps that follow each other are joined
std::string perfetto_timeline(const TimelineEvents& events, const RunResult& run,
                              std::size_t most_bytes_of_frame = kMostBytesOfFrame);

}  // namespace leviosim::tools
