// Where in a flight an odometry is started: every so many seconds, wherever the vehicle moves then.
// The rule looks at the truth and the clock only, so that no start is chosen for what comes of it.
#pragma once

#include <cstdint>
#include <vector>

#include "traces/datasets/frame_range.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {

/// A vehicle moves that is faster than this on average over the first second. [m/s] Ground truth of
/// a vehicle that stands jitters by millimetres.
inline constexpr double kLeastSpeed = 0.1;

struct Starts {
  std::vector<std::size_t> frames;  ///< numbers of the frames at which to start, rising
  std::size_t at_rest = 0;          ///< starts left out, since the vehicle does not move
};

/// The first frame after every full multiple of `every_s` since frame 0, but not frame 0, at which
/// a flight begins anyway.
/// @param stamps_ns  of the frames, rising; within the truth
Starts starts_in_motion(const std::vector<std::int64_t>& stamps_ns, const traces::Trajectory& truth,
                        double every_s);

/// Length of the true path between two times, along all its samples. [m]
double true_path_m(const traces::Trajectory& truth, std::int64_t begin_ns, std::int64_t end_ns);

/// The ranges as few as possible: in order, and those put together that overlap or touch.
std::vector<traces::FrameRange> merged(std::vector<traces::FrameRange> ranges);

/// Where a range lies in the row of all frames of merged ranges, one of which holds it.
traces::FrameRange within(const std::vector<traces::FrameRange>& merged,
                          const traces::FrameRange& range);

}  // namespace leviosim::tools
