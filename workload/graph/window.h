// What the optimiser works on: a snapshot of the pose graph, taken when a keyframe was added, and
// published back when an iteration has finished, so that nobody sees half of it. Meanwhile
// the front end goes on with the graph; a keyframe or landmark slot that it gave to somebody else
// is not written.
//
// The snapshot leaves out landmarks seen by one keyframe only: they constrain nothing. It sorts the
// observations by landmark, because the optimiser eliminates one landmark after the other. It
// replaces the covariance of each inertial interval by its Cholesky factor, with which the
// interval's residual is whitened.
//
// Uncertain gravity (standard deviation σ in each component, PARAMETERS.md#pre-integration: 1 m/s²)
// is taken as an error of the interval's velocity and position: it adds σ² dt² to the variance of
// velocity, σ² dt⁴/4 to that of position, and σ² dt³/2 between the two, because one and the same
// error enters both. That the intervals of a window share it is left out.
#pragma once

#include "workload/graph/pose_graph.h"

namespace leviosim::vio {

/// What the optimiser estimates. A bundle of views.
template <class P>
struct WindowState {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  Span poses;       ///< T_world_camera, kPoseFloats per keyframe, oldest first
  Span velocities;  ///< 3 per keyframe, world frame, m/s
  Span points;      ///< 3 per landmark, world frame, m

  Pose<P> pose(int k) const { return load_pose<P>(poses, k * kPoseFloats); }
  KeyframeState<P> keyframe(int k) const { return {pose(k), load_vec3<P>(velocities, 3 * k)}; }
  void set_keyframe(int k, const KeyframeState<P>& state) const {
    store_pose<P>(poses, k * kPoseFloats, state.T_world_camera);
    store_vec3<P>(velocities, 3 * k, state.velocity);
  }
};

/// A snapshot, in memory of its own. Copies share the memory.
template <class P>
struct Window {
  template <class T>
  using Span = typename P::template Span<T>;
  using F = typename P::F32;

  Window() = default;
  /// An empty window with room for all that a graph of this capacity can hold.
  Window(work::Arena& arena, const GraphCapacity& size);

  /// Motion between keyframes k - 1 and k (k ≥ 1). Its covariance() is the Cholesky factor of the
  /// covariance (cholesky_factor), and its duration is 0 if it constrains nothing.
  Preintegration<P> interval(int k) const {
    constexpr int kFloats = Preintegration<P>::kFloats;
    return Preintegration<P>(intervals.subspan(k * kFloats, kFloats));
  }

  /// Makes what it holds of a trial its own state.
  void adopt(const WindowState<P>& trial) const {
    for (int i : P::range(0, kPoseFloats * keyframes)) state.poses[i] = F(trial.poses[i]);
    for (int i : P::range(0, 3 * keyframes)) state.velocities[i] = F(trial.velocities[i]);
    for (int i : P::range(0, 3 * landmarks)) state.points[i] = F(trial.points[i]);
  }

  GraphCapacity capacity;
  int keyframes = 0;  ///< oldest first
  int landmarks = 0;  ///< each seen by two keyframes at least

  WindowState<P> state;
  KeyframeState<P> anchor;  ///< what the oldest keyframe is held to
  ImuBias<P> bias;
  BiasPrior<P> bias_prior;
  bool bias_is_new = false;             ///< estimated since the snapshot, to be published
  Vec3<P> gravity;                      ///< world frame, m/s²
  Vec3<P> lever_arm{0.0f, 0.0f, 0.0f};  ///< the IMU in the camera frame, m; where it is used

  Span<F> intervals;
  Span<typename P::I32> keyframe_slots, keyframe_ids;  ///< in the graph
  Span<typename P::U16> landmark_slots;                ///< in the graph
  Span<typename P::Byte> landmark_generations;         ///< at the time of the snapshot
  Span<typename P::Byte> lost;  ///< 1 if the last linearisation could not use the landmark
  /// Observations of landmark i: first_observations[i] and as many as observation_numbers[i] says,
  /// in ascending order of keyframes.
  Span<typename P::U16> first_observations;
  Span<typename P::Byte> observation_numbers;
  Span<typename P::Byte> observation_keyframes;
  Span<typename P::U16> observation_u, observation_v;
};

/// Adds to the prior of the biases what the intervals say that have left the graph since the last
/// snapshot. Call it before the next one.
template <class P>
void absorb_departed_intervals(const Window<P>& window, const PoseGraph<P>& graph,
                               const ImuNoise& noise, const BiasOptions& options);

/// Fills `window` from the graph, whose capacity it has.
/// @param arena  for some kB of scratch, freed on return
template <class P>
void take_snapshot(const PoseGraph<P>& graph, const ImuNoise& noise, work::Arena& arena,
                   Window<P>& window);

/// Writes keyframes and landmarks back to the graph, except where a slot has been reused, and the
/// biases if they have been estimated. Landmarks that are lost retire: the optimiser cannot move
/// them any more, and a map of them would contradict the window for as long as it is recognised.
template <class P>
void publish(const Window<P>& window, const PoseGraph<P>& graph);

/// Estimates the biases of the window from its intervals (bias_estimation.h), poses held fixed.
template <class P>
void estimate_biases(Window<P>& window, const ImuNoise& noise, const BiasOptions& options);

}  // namespace leviosim::vio
