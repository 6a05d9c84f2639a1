// Joins steps that are too short to be told apart, so that a frame of thousands of them can still
// be shown. Sums are kept: the cycles of each core by mechanism, and the bytes moved.
#pragma once

#include "tools/app/timeline/frame_events.h"

namespace leviosim::tools {

/// The stage with its neighbouring steps joined into one, wherever two or more follow each other
/// that take less than `shortest` each. The work of each core in them becomes one segment, from its
/// first work to its last; their transfers become one in each direction.
StageEvents with_short_steps_joined(const StageEvents& stage, Cycles shortest);

}  // namespace leviosim::tools
