// The odometry as its callers see it: frames and IMU samples in, a pose per frame out, and an
// optimiser that works beside the front end. Which arithmetic policy runs inside is chosen when it
// is made; both compute the same bits.
//
//   begin_optimisation()                snapshot of the pose graph           at a frame's start
//   process_frame(input)                the front end, on the cluster
//   optimise() × iterations             on the snapshot, on the controller   meanwhile
//   publish()                           what was found becomes visible       when that has finished
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "workload/vio/records.h"

namespace leviosim::work {
class Arena;
class Machine;
}  // namespace leviosim::work

namespace leviosim::vio {

struct Profile;

struct OptimiserReport {
  bool ran = false;  ///< false while there is nothing to optimise yet
  bool accepted = false;
  float cost_before = 0;
  float cost_after = 0;
};

/// The names of the stages, in the order in which a frame passes them, and what one call of each
/// is.
struct StageName {
  std::string_view name;
  std::string_view per;  ///< "frame", "sample", "iteration"
  bool on_controller;
};
std::vector<StageName> stage_names(const Profile& profile);

/// Name of the block by which the controller's memory accounts for the two memories below.
inline constexpr std::string_view kPersistentBlock = "last keyframe and pose graph";

class Odometry {
 public:
  virtual ~Odometry() = default;

  virtual FrameReport process_frame(const FrameInput& input) = 0;

  /// Takes a snapshot. @returns false if there is nothing to optimise yet.
  virtual bool begin_optimisation() = 0;
  /// One Levenberg–Marquardt iteration on the snapshot.
  virtual OptimiserReport optimise() = 0;
  /// Makes what the iterations since begin_optimisation() found visible to the front end.
  virtual void publish() = 0;

  /// Persistent blocks in L2: the last keyframe, the pose graph, and what loop closure keeps, which
  /// is nothing where it is off.
  virtual const work::Arena& last_keyframe_memory() const = 0;
  virtual const work::Arena& pose_graph_memory() const = 0;
  virtual const work::Arena& loop_memory() const = 0;
};

/// The profile with what depends on the images, as make_odometry() runs it: the optimiser's camera
/// is the rig's, and its limit of lost observations the same share of the image width. Where
/// corners lie between pixels, all its lengths are in those finer units.
Profile fitted_to(const Rig& rig, Profile profile);

/// @param counting    on counted scalars, so that recording machines get work; else natively
/// @param cluster     where the front end runs; its memory is L1
/// @param controller  where the optimiser runs; its memory is L2
std::unique_ptr<Odometry> make_odometry(bool counting, const Profile& profile, const Rig& rig,
                                        work::Machine& cluster, work::Machine& controller);

}  // namespace leviosim::vio
