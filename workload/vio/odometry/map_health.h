// What the odometry knows of its map without the truth, from numbers that its parts have anyway:
//
//   scale        is not known before the map is aligned, and then as well as the alignment has it
//   consistency  residuals of images, IMU and past in the window, against the noise assumed of them
//   bias         of the accelerometer: one that no sensor has explains a path that was not flown
//   tracking     share of the matches with landmarks that agree with the pose, over a second
//   drift        of poses that the IMU alone moved on, that come from a contradictory window or one
//                that could not be solved, or from before the map was lost, and what images put
//                right when they came back, as a share of the path. It stays, for nothing undoes
//                it, and matters less the longer the path gets
//
// A few operations a frame, which are not counted.
#pragma once

#include <array>
#include <optional>

#include "workload/vio/map_status.h"
#include "workload/vio/profile.h"
#include "workload/vio/records.h"

namespace leviosim::vio {

class MapHealth {
 public:
  /// @param profile, map  outlive this
  MapHealth(const Profile& profile, const MapStatus& map) : profile_(profile), map_(map) {}

  /// The optimiser has made what it found visible.
  void take_window();
  /// @param report  of a frame, health excepted
  /// @param dt      since the frame before [s]
  Health after_frame(const FrameReport& report, float dt);

 private:
  void track(const FrameReport& report, float dt);
  void add_drift(const FrameReport& report, float dt);
  bool waits() const;
  bool contradicts_imu() const;

  const Profile& profile_;
  const MapStatus& map_;
  std::optional<std::array<float, 3>> last_;  ///< position [m]
  bool was_aligned_ = false;
  bool restarted_ = false;     ///< an aligned map was given up; the next one is not aligned yet
  bool inconsistent_ = false;  ///< the last window
  float doubted_s_ = 0;        ///< for which an inconsistent window still counts
  float blind_s_ = 0;          ///< that the IMU alone has carried the pose for
  float tracked_ = 1;          ///< share of the matches that agree, over a second
  float path_m_ = 0;
  float unaligned_m_ = 0;  ///< of the path, while the map waited
  float drift_m_ = 0;
};

}  // namespace leviosim::vio
