// How far the clocks of camera and IMU are apart, found after a run: the rotations between poses
// that were located from images are compared with what the gyro measured between the same stamps,
// and between stamps a little earlier and later. Translation does not matter, since the poses have
// taken it apart; a constant bias does not either. The poses are predicted by the gyro, too, which
// draws what is found towards zero by a fifth or so.
//
// Left out: an offset that changes; offsets of more than a tenth of a second.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/result/run_result.h"
#include "traces/datasets/dataset.h"

namespace leviosim::tools {

/// What is added to stamps of images to put them on the IMU's clock, as Kalibr's
/// `timeshift_cam_imu`.
struct ClockOffset {
  double seconds = 0;
  double deviation = 0;  ///< of it, by the scatter of the rotations [s]

  /// Whether it is more than chance, and large enough to matter.
  bool is_certain() const;
  /// "images follow the IMU by 45 ms: …".
  std::string text() const;
};

/// Absent where too few poses in a row were located, and where the vehicle did not turn enough.
std::optional<ClockOffset> find_clock_offset(const std::vector<traces::ImuSample>& imu,
                                             const std::vector<FrameResult>& frames);

}  // namespace leviosim::tools
