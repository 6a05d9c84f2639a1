// The odometry's judgement of its map without ground truth, from numbers that its parts compute
// anyway:
//
//   scale        unknown before the map is aligned; then full windows give its uncertainty. A
//                window in a wrong minimum underestimates it, so what windows changed the length of
//                the path by in the last second is added: noise cancels there, a map that wanders
//                on does not
//   consistency  residuals of images, IMU and prior in the window, against their assumed noise
//   bias         of the accelerometer: a wrong path shows as a bias that no sensor has
//   tracking     share of the matches with landmarks that agree with the pose, over a second of
//                frames that have such a pose
//   drift        uncertainty of the path, in metres: beside its length, and beside the noise of
//                poses, below which it is not seen. The sum, over its parts, of the scale's
//                uncertainty, since windows inherit it from each other; of the whole part where it
//                contradicts the IMU or its window could not be solved; of the error of poses from
//                the IMU alone, whose velocity is known after rest; of the correction when images
//                came back; and of what may be missing where a map was lost. It never shrinks, but
//                weighs less as the path grows. Poses that wait for the alignment have the map's
//                present scale. A map that begins anew at rest leaves the path before it with the
//                scale that was known then; where none was known, its poses are guesses, which are
//                not judged
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

  /// The optimiser has published its results.
  void take_window();
  /// @param report  of a frame, health excepted
  /// @param dt      since the frame before [s]
  Health after_frame(const FrameReport& report, float dt);
  /// Why it was not good: bits of HealthReason.
  int reasons() const { return reasons_; }
  /// Length of the path so far, guesses excepted, m.
  float path() const;
  /// Standard deviation of that length, m.
  float path_deviation() const;

 private:
  void track(const FrameReport& report, float dt);
  void follow_corrections(const std::vector<EarlierPose>& earlier, float dt);
  void add_drift(const FrameReport& report, float dt);
  void settle(float sigma);
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
  float doubted_s_ = 0;        ///< time for which an inconsistent window still counts [s]
  float blind_s_ = 0;          ///< time for which the IMU alone has moved the pose on [s]
  float tracked_ = 1;          ///< share of the matches that agree, over a second
  float open_m_ = 0;           ///< path whose poses are still corrected [m]
  float path_m_ = 0;           ///< path before it [m]
  float drift_m_ = 0;          ///< uncertainty of that path [m]
  float velocity_error_ = 0;   ///< of the last pose that was not blind [m/s]
  float sigma_ = 0;            ///< of the scale, after the last frame
  std::vector<EarlierPose> earlier_;  ///< corrected poses of the last frame
  float corrections_ = 0;             ///< relative changes of their length in the last second
};

}  // namespace leviosim::vio
