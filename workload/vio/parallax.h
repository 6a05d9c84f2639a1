// Parallax since the last keyframe, which decides whether a frame becomes a keyframe.
#pragma once

#include <optional>

#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// What is left of a match's motion since the last keyframe when a rotation is undone.
template <class P>
struct Parallax {
  Vec2<P> seen;   ///< the feature in the present frame, normalised
  Vec2<P> moved;  ///< likewise
};

/// Of match i. Works inside a stage.
template <class P>
Parallax<P> parallax_of(const FrontEndState<P>& state, const Frame<P>& frame, int i,
                        const Mat3<P>& R_camera_keyframe);

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

}  // namespace leviosim::vio
