// Matches of what moves by itself: no translation of the camera explains them.
//
// The gyro tells the rotation since the keyframe; undone, the matches of the world move along lines
// that meet in one point, all away from it or all towards it. Pairs of matches from different parts
// of the picture give such points, and the one that most matches agree with is kept. What disagrees
// with it by pixels is not of the world.
//
// What moves by itself moves along those lines, too, at times. So where most matches of a cell of
// the picture were seen to move by themselves, all of its features are held for such, for some
// keyframes.
//
// Left out: the noise of the gyro; what never moves across the lines.
#pragma once

#include "workload/next/foreign_matches.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

template <class P>
class OwnMotion {
 public:
  /// @param state, inertial  outlive this
  /// @param memory  in L2, two bytes for each feature
  OwnMotion(const FrontEndState<P>& state, const InertialPart<P>& inertial, work::Arena& memory);

  /// Takes the matches with the last keyframe that moved by themselves off the list, and gives up
  /// the landmarks that they show.
  void drop_from(Frame<P>& frame);
  /// @param keyframe  the frame has become the last keyframe
  void end_frame(bool keyframe);

 private:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  using Bytes = typename P::template L2Span<Byte>;
  using Flags = typename P::template Span<Byte>;
  using Marks = typename P::template EitherSpan<Byte>;

  struct Flow;
  Flow flow_of(const Frame<P>& frame) const;
  Vec3<P> most_agreed(const Flow& flow) const;
  void judge(const Flow& flow, const Frame<P>& frame, Marks moves);

  const FrontEndState<P>& state_;
  const InertialPart<P>& inertial_;
  PictureCells<P> cells_;
  Bytes known_;  ///< for how many keyframes a feature of the last one is held for moving by itself
  Bytes next_;   ///< the same of the features of the present frame, if it is
  bool judged_ = false;  ///< the present frame
};

}  // namespace leviosim::vio
