// A frame on its way through a front end: its features, their matches with the last keyframe, and
// its pose. The first and the last step of it, which both front ends share, are here too.
#pragma once

#include "workload/vio/front_end_state.h"
#include "workload/vio/keyframe_record.h"
#include "workload/vision/matcher.h"

namespace leviosim::vio {

/// Matches with the features of the last keyframe, and what is known of those; in L1 if they have
/// room there.
template <class P>
struct KeyframeMatches {
  using I32 = typename P::I32;
  using Table = typename P::template EitherSpan<typename P::U16>;

  /// Where the keyframe's feature `old` is.
  I32 u(I32 old) const { return pixels[old]; }
  I32 v(I32 old) const { return pixels[I32(old + I32(first_v))]; }

  MatchList<P> list;  ///< current feature → feature of the last keyframe
  Table pixels;       ///< u of all keyframe features, from first_v on their v
  int first_v = 0;
  Table landmarks;     ///< of the keyframe features
  bool in_l2 = false;  ///< both tables are the keyframe's own
};

template <class P>
struct Frame {
  ObservedFeatures<P> features;
  KeyframeMatches<P> matches;
  Pose<P> T_world_camera{};
};

/// The descriptors of the frame's features, where they lie.
template <class P>
DescriptorSource<P> descriptors_of(const Frame<P>& frame) {
  const FeatureList<P>& features = frame.features.list;
  return {features.descriptors, features.count, features.descriptors_in_l2, "tile of descriptors"};
}

/// Takes the image, as the camera interface does, and counts the frame.
template <class P>
void take_image(const FrameInput& input, FrontEndState<P>& state);

/// Features of the image in L2, without landmarks; they stay in L1.
template <class P>
void extract_frame(FrontEndState<P>& state, Frame<P>& frame);

/// No feature shows a landmark.
template <class P>
void forget_landmarks(const Frame<P>& frame);

/// The pose of the camera, as plain numbers.
template <class P>
CameraPose plain(const Pose<P>& T_world_camera);

/// What the frame came to, as plain numbers, with its features where they are asked for.
template <class P>
void complete(const FrontEndState<P>& state, const Frame<P>& frame, FrameReport& report);

}  // namespace leviosim::vio
