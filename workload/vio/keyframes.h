// Insertion of a keyframe: its pose in the pose graph, observations of known landmarks, and new
// landmarks triangulated with the keyframe before (paper III.B.5–6).
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Puts the frame, whose pose is known, into the graph, and its features into the place of the last
/// keyframe's.
/// @param any_depth  depth [m] that new landmarks get without triangulation, and all matches are
///                   accepted; 0: landmarks are triangulated
template <class P>
void insert_keyframe(FrontEndState<P>& state, Frame<P>& frame, float any_depth);

/// Velocity of the camera in the world: the last keyframe's, carried on by the IMU; without an IMU,
/// the mean since the last keyframe.
/// @param interval  the motion since the last keyframe
/// @tparam Graph  PoseGraph in whatever memory
template <class P, class Graph>
Vec3<P> velocity_at(const FrontEndState<P>& state, const Pose<P>& T_world_camera,
                    const Graph& graph, typename P::template Span<typename P::F32> interval);

/// The frame's features take the place of the last keyframe's. Works inside a stage.
template <class P>
void store_keyframe(FrontEndState<P>& state, const Frame<P>& frame);

}  // namespace leviosim::vio
