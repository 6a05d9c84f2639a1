// What a frame that becomes a keyframe leaves behind: a keyframe in the pose graph, observations of
// known landmarks, and new landmarks triangulated with the keyframe before (paper III.B.5–6).
#pragma once

#include <optional>

#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Puts the frame, whose pose is known, into the graph, and its features into the place of the last
/// keyframe's.
/// @param any_depth  0 if poses can tell where landmarks are; else those that are new get this
/// depth
///                   (m), and all matches are believed
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

// Matching with the last keyframe, of which L2 holds the features (front_end_state.h).

/// Room for the matches in L1, for as long as the caller needs them.
template <class P>
void alloc_keyframe_matches(const FrontEndState<P>& state, Frame<P>& frame);

/// The keyframe's descriptors for matching. In L1, if they have room there beside what the pose of
/// the frame may take; the caller frees them when it is known (paper, memory table: 8-point). Else
/// they pass in tiles. Works inside a stage.
/// @param number  of features that are copied
template <class P>
DescriptorSource<P> keyframe_descriptors(const FrontEndState<P>& state, int number);

/// Fills frame.matches, and leaves the keyframe's descriptors in L1 above them.
template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame);

// How far the features have moved since the last keyframe, from which a frame that becomes a
// keyframe is known.

/// Sum over the matches with the last keyframe, in normalised coordinates. Parallax is what remains
/// of the motion of the matches when the rotation since the keyframe is undone: the rotation that
/// the gyro measured, for a wrong pose would look like parallax, and every frame after it would
/// become a keyframe. Only without an IMU it is that of the poses. Works inside a stage.
template <class P>
typename P::F32 total_parallax(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                               const Frame<P>& frame);

/// How far the camera has moved since the last keyframe, over the distance of what it sees: the
/// translation that explains the parallax best if all is equally far. Nothing is known of it with
/// fewer than min_frame_matches, or half of all, that have moved by less than `most`. Works inside
/// a stage.
/// @param R_camera_keyframe  the rotation since then
/// @param most               in normalised coordinates; a match that moved farther is a wrong one
template <class P>
std::optional<Vec3<P>> motion_over_distance(const FrontEndState<P>& state, const Frame<P>& frame,
                                            const Mat3<P>& R_camera_keyframe, float most);

// How a map begins: a frame becomes the first keyframe of an empty graph.

/// The first frame: its camera frame is the world, or, for the joint optimiser, one with the same
/// origin whose z axis points up. Gravity is the mean force so far.
template <class P>
void start_map(FrontEndState<P>& state, Frame<P>& frame);

/// A map with the frame as its only keyframe, at frame.T_world_camera and at rest. Works inside a
/// stage.
/// @param record   Preintegration::kFloats in L1, for the motion since this keyframe
/// @param gravity  in the world frame [m/s²]
template <class P>
void begin_map(FrontEndState<P>& state, const Frame<P>& frame,
               typename P::template Span<typename P::F32> record, const ImuBias<P>& bias,
               const Vec3<P>& gravity);

}  // namespace leviosim::vio
