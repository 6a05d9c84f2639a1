// The back end: the sliding-window optimiser on the fabric controller. It works on a snapshot of
// the pose graph while the front end goes on, and publishes its result when it is done.
#pragma once

#include "sim/work/machine.h"
#include "workload/graph/alignment.h"
#include "workload/graph/marginalisation.h"
#include "workload/graph/optimiser.h"
#include "workload/graph/pose_graph.h"
#include "workload/graph/window.h"
#include "workload/vio/map_status.h"
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

  bool has_enough_snapshots();
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
  int snapshots_ = 0;        ///< snapshots taken of it
  WindowFit fit_;            ///< fit before the last iteration
  bool solved_ = false;      ///< the system of this snapshot could be solved
  bool aligns_ = false;      ///< this snapshot is of a map that is not aligned yet
  bool ambiguous_ = false;   ///< the last alignment from several starts left two scales
  bool compares_ = false;    ///< the next alignment begins from several starts
  bool compared_ = false;    ///< the alignment of this snapshot began from several starts
  bool arrived_ = false;     ///< its alignment is at its minimum: more iterations gain nothing
  bool converged_ = false;   ///< its alignment is near its minimum
  bool determined_ = false;  ///< its alignment has converged, and its uncertainty is small enough
};

}  // namespace leviosim::vio
