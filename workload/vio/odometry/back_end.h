// The back end: the sliding-window optimiser on the fabric controller. It works on a snapshot of
// the pose graph while the front end goes on, and publishes what it found when it is done.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "sim/work/machine.h"
#include "workload/graph/alignment.h"
#include "workload/graph/marginalisation.h"
#include "workload/graph/optimiser.h"
#include "workload/graph/pose_graph.h"
#include "workload/graph/window.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"
#include "workload/vio/records.h"

namespace leviosim::vio {

template <class P>
class BackEnd {
 public:
  /// @param graph, map  in L2; shared with the front end
  BackEnd(const Profile& profile, const Rig& rig, work::Machine& controller,
          const PoseGraph<P>& graph, MapStatus& map);

  bool begin();
  OptimiserReport optimise();
  void publish();

 private:
  using F = typename P::F32;
  using I32 = typename P::I32;

  bool is_settled();
  WindowFit fit_of(const IterationReport& report) const;
  void publish_alignment();
  void retire_unplaced();
  void update_prior();
  void follow_positions();
  void move_newer_keyframes(const Pose<P>& T_new_old);
  void carry_newer_keyframes(const Pose<P>& T_new_old);

  const Profile& profile_;
  const OptimiserOptions& options_;
  work::Machine& machine_;
  PoseGraph<P> graph_;
  MapStatus& map_;
  Window<P> window_;
  WindowPrior<P> prior_;  ///< only if the optimiser works jointly
  LmState<P> damping_;
  AlignmentState<P> alignment_;
  int newest_ = -1;          ///< serial number of the newest keyframe
  int snapshots_ = 0;        ///< that were taken of it
  WindowFit fit_;            ///< before the last iteration
  bool solved_ = false;      ///< the system of this snapshot could be solved
  bool aligns_ = false;      ///< this snapshot is of a map that is not aligned yet
  bool ambiguous_ = false;   ///< when it last began from several starts, two scales were left
  bool compares_ = false;    ///< its alignment is to begin from several starts
  bool compared_ = false;    ///< this snapshot's does, or did
  bool arrived_ = false;     ///< its alignment is at its minimum: more iterations gain nothing
  bool converged_ = false;   ///< its alignment is near its minimum
  bool determined_ = false;  ///< its alignment has converged, and tells enough
};

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
