// What became of the features of a frame, for pictures of it (FrameReport::seen). The host alone
// computes it: nothing is counted, and nothing is done where it was not asked for.
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Matches with landmarks, as the refinement of a pose judged them. @param inliers  1 or 0 per
/// match
template <class P>
void note_inliers_on_host(const Frame<P>& frame, const MatchList<P>& matches,
                          typename P::template Span<typename P::Byte> inliers, FrameReport& report);

/// Features that show landmarks, judged as EPnP RANSAC judges a hypothesis.
template <class P>
void note_reprojections_on_host(const FrontEndState<P>& state, const Frame<P>& frame,
                                const Pose<P>& T_camera_world, FrameReport& report);

/// All features of a frame that is complete; a keyframe has been inserted.
template <class P>
void note_features_on_host(const FrontEndState<P>& state, const Frame<P>& frame,
                           FrameReport& report);

}  // namespace leviosim::vio
