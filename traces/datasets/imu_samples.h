// The IMU samples that belong to each frame: those after the previous frame, up to and including
// the frame itself (10 per frame for 200 Hz and 20 frames/s).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

/// The samples with after_ns < t <= up_to_ns.
std::span<const ImuSample> imu_between(std::span<const ImuSample> samples, std::int64_t after_ns,
                                       std::int64_t up_to_ns);

/// The batch of frame i of `data`. Before frame 0 it reaches back by one nominal frame period, as
/// far as there are samples. A batch grows where the camera skipped a frame and may be empty at the
/// edges of the recording.
std::span<const ImuSample> imu_batch(const Dataset& data, std::size_t frame);

/// The sample at a time within the recording, interpolated linearly between its neighbours. Throws
/// InputError outside the recording.
ImuSample interpolate_imu(std::span<const ImuSample> samples, std::int64_t t_ns);

}  // namespace leviosim::traces
