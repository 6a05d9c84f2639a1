#include "workload/vio/odometry/back_end.h"

#include <utility>

#include "sim/work/functions.h"
#include "workload/graph/carried_poses.h"
#include "workload/graph/departing_visual_terms.h"
#include "workload/levio/optimiser/levio_optimiser.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
BackEnd<P>::BackEnd(const Profile& profile, const Rig& rig, work::Machine& controller,
                    const PoseGraph<P>& graph, MapStatus& map)
    : profile_(profile),
      options_(profile.optimiser),
      machine_(controller),
      graph_(graph),
      map_(map),
      window_(controller.local(), graph.capacity),
      damping_(options_),
      alignment_{profile.alignment.initial_lambda, profile.alignment.inverse_depth} {
  if (!options_.joint) return;
  prior_ = WindowPrior<P>(controller.local(), graph.capacity.keyframes);
  window_.lever_arm = {rig.p_camera_body[0], rig.p_camera_body[1], rig.p_camera_body[2]};
}

template <class P>
bool BackEnd<P>::begin() {
  aligns_ = profile_.initialises() && !map_.aligned;
  const int least = aligns_ ? profile_.alignment.min_keyframes : 2;
  if (work::value(graph_.keyframe_count()) < least) return false;
  if (options_.joint && has_enough_snapshots()) return false;
  const auto stage = machine_.stage(stages::kOptimiserUpdate);
  determined_ = false;
  if (aligns_) {
    prior_.keyframes = 0;
  } else if (options_.joint) {
    update_prior();
  } else if (profile_.use_imu) {
    absorb_departed_intervals<P>(window_, graph_, profile_.imu_noise, profile_.biases);
  }
  take_snapshot<P>(graph_, profile_.imu_noise, machine_.local(), window_);
  if (options_.joint && !aligns_ && prior_.keyframes == 0)
    start_prior<P>(window_, options_.prior, prior_);
  if (!aligns_) {
    damping_ = LmState<P>(options_);
  } else {
    // Not twice in a row: a comparison takes a few frames, in which the newest keyframe becomes
    // another one.
    compares_ = snapshots_ == 1 && !compared_;
    compared_ = compares_;
    arrived_ = false;
    if (snapshots_ == 1)
      alignment_ = {profile_.alignment.initial_lambda,
                    map_.inverse_depth > 0 ? map_.inverse_depth : profile_.alignment.inverse_depth};
  }
  solved_ = false;
  fit_.scale_sigma = map_.fit.scale_sigma;  // until an iteration measures it
  return true;
}

/// Whether the newest keyframe has had its share of iterations. More of them only wander along what
/// the window hardly determines, and move a vehicle that stands still.
template <class P>
bool BackEnd<P>::has_enough_snapshots() {
  const int newest = work::value(I32(graph_.keyframe_ids[graph_.newest_keyframe()]));
  if (newest != newest_) snapshots_ = 0;
  newest_ = newest;
  return ++snapshots_ > profile_.max_snapshots;
}

/// Marginalises the keyframes that have left the graph since the last snapshot, from which they
/// have not gone yet. If none is left, which takes a queue of frames, the past is dropped.
template <class P>
void BackEnd<P>::update_prior() {
  if (prior_.keyframes == 0) return;
  const I32 oldest = graph_.keyframe_ids[graph_.keyframe_slot(0)];
  int departed = 0;
  // uncounted: rounds, one more than the keyframe or two that have left; the comparison is
  while (departed < window_.keyframes && I32(window_.keyframe_ids[departed]) < oldest) ++departed;
  if (departed == window_.keyframes) {
    prior_.keyframes = 0;
  } else if (departed > 0) {
    marginalise<P>(machine_, window_, departed, options_.visual, options_.prior, prior_);
    forget_departed<P>(window_, departed, options_.prior.tracked_landmarks, graph_);
  }
}

template <class P>
OptimiserReport BackEnd<P>::optimise() {
  if (aligns_) {
    if (arrived_) return {true, false, 0, 0};
    const auto stage = machine_.stage(stages::kInitialisation);
    const bool compares = std::exchange(compares_, false);
    const AlignmentReport report =
        compares
            ? align_from_all<P>(machine_, window_, alignment_, options_, profile_.alignment)
            : align_once<P>(machine_, window_, alignment_, options_, profile_.alignment, false);
    solved_ = solved_ || report.positive_definite;
    converged_ = report.converged;
    arrived_ = !compares && report.arrived;
    if (compares) ambiguous_ = report.ambiguous;
    fit_.scale_sigma = report.uncertainty;
    determined_ = report.determined && !ambiguous_;
    return {true, report.accepted, report.cost_before, report.cost_after};
  }
  const auto stage = machine_.stage(stages::kOptimiser);
  const IterationReport report =
      options_.joint ? optimise_jointly_once<P>(machine_, window_, prior_, damping_, options_)
                     : levio::optimise_once<P>(machine_, window_, damping_, options_);
  if (profile_.use_imu && !options_.joint)
    estimate_biases<P>(window_, profile_.imu_noise, profile_.biases);
  solved_ = solved_ || report.positive_definite;
  fit_ = fit_of(report);
  return {true, report.accepted, report.cost_before, report.cost_after};
}

/// Each observation has two residuals and each landmark takes three unknowns; each interval has
/// six, for its velocities are free.
template <class P>
WindowFit BackEnd<P>::fit_of(const IterationReport& report) const {
  const auto mean_square = [](float cost, int number) {
    return number > 0 ? 2 * cost / static_cast<float>(number) : 0.0f;
  };
  const Vec3<P>&bias = window_.bias.accel, &expected = window_.bias_prior.mean.accel;
  const Vec3<work::Native> off{work::value(bias.x) - work::value(expected.x),
                               work::value(bias.y) - work::value(expected.y),
                               work::value(bias.z) - work::value(expected.z)};
  return {mean_square(report.visual, 2 * report.observations - 3 * report.landmarks),
          mean_square(report.inertial, 6 * (window_.keyframes - 1)),
          mean_square(report.prior, options_.joint ? prior_.unknowns() : 9),
          report.scale_sigma.value_or(fit_.scale_sigma),
          report.positive_definite,
          work::sqrt(dot(off, off)) / options_.prior.accel_bias};
}

template <class P>
void BackEnd<P>::publish() {
  const auto stage = machine_.stage(stages::kOptimiserUpdate);
  if (!profile_.use_imu) follow_positions();
  if (!solved_) prior_.keyframes = 0;  // rounding has spoilt it: the next window starts a new one
  const int last = window_.keyframes - 1;
  const I32 slot = window_.keyframe_slots[last];
  const bool still_there = bool(I32(graph_.keyframe_ids[slot]) == I32(window_.keyframe_ids[last]));
  const Pose<P> before = graph_.keyframe(slot).T_world_camera;
  if (aligns_) return publish_alignment();
  vio::publish<P>(window_, graph_);
  if (still_there) move_newer_keyframes(window_.state.pose(last) * inverse(before));
  map_.fit = fit_;
}

/// A map is aligned as a whole: keyframes that are newer than the snapshot follow its last one.
/// Landmarks that the alignment had no place for are given up then.
template <class P>
void BackEnd<P>::publish_alignment() {
  const int last = window_.keyframes - 1;
  map_.converged =
      map_.converged || (converged_ && window_.keyframes > profile_.alignment.few_keyframes);
  map_.inverse_depth = work::value(alignment_.inverse_depth);
  const I32 slot = window_.keyframe_slots[last];
  const bool still_there = bool(I32(graph_.keyframe_ids[slot]) == I32(window_.keyframe_ids[last]));
  const bool aligned = determined_ && still_there;
  if (!aligned)
    for (int i : P::range(0, window_.landmarks))
      window_.lost[i] = work::narrow<typename P::Byte>(I32(0));
  const Pose<P> before = graph_.keyframe(slot).T_world_camera;
  vio::publish<P>(window_, graph_);
  if (still_there) move_newer_keyframes(window_.state.pose(last) * inverse(before));
  if (!aligned) return;
  retire_unplaced();
  map_.aligned = true;
  map_.fit = {};
  map_.fit.scale_sigma = fit_.scale_sigma;
  newest_ = -1;
}

/// Landmarks that the window does not hold, seen once, still lie at the distance that any may have.
template <class P>
void BackEnd<P>::retire_unplaced() {
  using Byte = typename P::Byte;
  work::Arena& arena = machine_.local();
  const work::Arena::Frame memory(arena);
  const int landmarks = work::value(graph_.landmark_count());
  const auto placed =
      arena.alloc<typename P::template Span<Byte>>("landmarks with a place", landmarks);
  for (int i : P::range(0, landmarks)) placed[i] = work::narrow<Byte>(I32(0));
  for (int i : P::range(0, window_.landmarks))
    placed[I32(window_.landmark_slots[i])] = work::narrow<Byte>(I32(1));
  for (int i : P::range(0, landmarks))
    if (I32(placed[i]) == I32(0)) graph_.retire_landmark(i);
}

/// Without an IMU a keyframe's velocity is that at which it was reached from the one before, and
/// the optimiser, which has moved both, knows nothing of it. It gives the next 8-point pose its
/// length: left as it was, the scale of the map would run away from that of the poses added to it.
template <class P>
void BackEnd<P>::follow_positions() {
  for (int k : P::range(1, window_.keyframes)) {
    const F dt = window_.interval(k).duration();
    if (!(dt > 0.0f)) continue;
    KeyframeState<P> state = window_.state.keyframe(k);
    const Vec3<P> moved = state.T_world_camera.t - window_.state.pose(k - 1).t;
    state.velocity = moved * F(F(1.0f) / dt);
    window_.state.set_keyframe(k, state);
  }
}

/// Keyframes added since the snapshot were placed relative to the last one in it: they follow it.
template <class P>
void BackEnd<P>::move_newer_keyframes(const Pose<P>& T_new_old) {
  if (options_.joint && profile_.use_imu) return carry_newer_keyframes(T_new_old);
  const int last = window_.keyframes - 1;
  const I32 last_id = window_.keyframe_ids[last];
  for (int k : P::range(0, work::value(graph_.keyframe_count()))) {
    const I32 slot = graph_.keyframe_slot(k);
    if (I32(graph_.keyframe_ids[slot]) <= last_id) continue;
    const KeyframeState<P> state = graph_.keyframe(slot);
    graph_.set_keyframe(slot, {T_new_old * state.T_world_camera, T_new_old.R * state.velocity});
  }
}

/// The same with what the IMU measured since the snapshot: the corrected velocity and biases are
/// carried on with it. If that is all that their poses came from, it places them, too: moved as a
/// whole they would keep the path that the old velocity led to, however late the result.
template <class P>
void BackEnd<P>::carry_newer_keyframes(const Pose<P>& T_new_old) {
  const int last = window_.keyframes - 1;
  const I32 last_id = window_.keyframe_ids[last];
  const Vec3<P> gravity = graph_.gravity();
  const ImuBias<P> bias = graph_.bias();
  KeyframeState<P> before = window_.state.keyframe(last);
  for (int k : P::range(0, work::value(graph_.keyframe_count()))) {
    const I32 slot = graph_.keyframe_slot(k);
    if (I32(graph_.keyframe_ids[slot]) <= last_id) continue;
    const Preintegration<P> interval(graph_.interval_record(slot));
    KeyframeState<P> now =
        carried_on<P>(before, interval.corrected(bias), gravity, window_.lever_arm);
    if (!aligns_) now.T_world_camera = T_new_old * graph_.keyframe(slot).T_world_camera;
    graph_.set_keyframe(slot, now);
    before = now;
  }
}

template class BackEnd<work::Native>;
template class BackEnd<work::Counting>;

}  // namespace leviosim::vio
