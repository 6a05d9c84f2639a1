// Samples of an IMU that are missing. Short gaps are bridged, long ones are refused with the parts
// of the flight that they leave.
#pragma once

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

/// The longest gap that is bridged. A rotation that is taken to be even over it is off by its
/// angular acceleration times its square over eight: 0.006 rad at 5 rad/s².
inline constexpr double kLongestBridgedGapS = 0.1;

/// Gaps around the frames of more than `longest_periods` nominal periods get samples on the line
/// between their ends, a nominal period apart; Dataset::notes says so.
/// @throws InputError for a gap above kLongestBridgedGapS, with the frames before and after it
void bridge_imu_gaps(Dataset& data, double longest_periods);

}  // namespace leviosim::traces
