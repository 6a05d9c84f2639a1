// The timeline of a run as a picture for documents, deterministic SVG: stages of the front end,
// what each core works and waits for, transfers, the controller. The file for Perfetto
// (perfetto_timeline.cpp) has every slice; here a column of the picture shows the shares of its
// time.
#pragma once

#include <string>

#include "tools/app/timeline/frame_events.h"

namespace leviosim::tools {

/// @param run  that the events are of
std::string timeline_picture(const TimelineEvents& events, const RunResult& run);

}  // namespace leviosim::tools
