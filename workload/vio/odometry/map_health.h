// What the odometry knows of its map without the truth, from numbers that its parts have anyway:
//
//   scale        is not known before the map is aligned; then full windows say how uncertain it is.
//                They say it of the minimum that they are in, which may be a wrong one: so by how
//                much they change the length of poses that are corrected still is added to it
//   consistency  residuals of images, IMU and past in the window, against the noise assumed of them
//   bias         of the accelerometer: one that no sensor has explains a path that was not flown
//   tracking     share of the matches with landmarks that agree with the pose, over a second of
//                frames that have such a pose
//   drift        as a share of the path: the uncertainty of the scale with which each part of it
//                was flown, all of a part that contradicts the IMU or whose window could not be
//                solved, what poses that the IMU alone moved on are wrong by, what images put right
//                when they came back, and what may be missing where a map was lost. It stays, for
//                nothing undoes it, and matters less the longer the path gets. Poses that wait for
//                the alignment are corrected until the map has settled: they have its present scale
//
// A few operations a frame, which are not counted.
#pragma once

#include <array>
#include <optional>
#include <vector>

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
  /// Why it was not good: bits of HealthReason.
  int reasons() const { return reasons_; }

 private:
  void track(const FrameReport& report, float dt);
  void follow_corrections(const std::vector<EarlierPose>& earlier, float dt);
  void add_drift(const FrameReport& report, float dt);
  bool waits() const;
  bool contradicts_imu() const;
  bool drifts() const;
  float scale_sigma() const;

  const Profile& profile_;
  const MapStatus& map_;
  std::optional<std::array<float, 3>> last_;  ///< position [m]
  int reasons_ = 0;
  bool was_aligned_ = false;
  bool restarted_ = false;     ///< an aligned map was given up; the next one is not aligned yet
  bool inconsistent_ = false;  ///< the last window
  float doubted_s_ = 0;        ///< for which an inconsistent window still counts
  float blind_s_ = 0;          ///< that the IMU alone has carried the pose for
  float tracked_ = 1;          ///< share of the matches that agree, over a second
  float open_m_ = 0;           ///< of the path, whose poses are corrected still
  float path_m_ = 0;           ///< of the rest
  float drift_m_ = 0;
  std::vector<EarlierPose> earlier_;  ///< as the last frame found them
  float corrections_ = 0;             ///< relative changes of their length, summed over a second
};

}  // namespace leviosim::vio
