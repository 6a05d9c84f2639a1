// Parts of the picture that move with the camera: a leg, a gripper, dirt on the lens. Their
// features stay on their pixels while the gyro turns, which nothing of the world does for long. The
// evidence is kept in cells of the picture, over keyframes: a match that stayed where the rotation
// alone would have moved it counts for its cell, one that moved counts against it.
//
// While the gyro's bias is not known, a vehicle at rest seems to turn, too: frames count only if
// other features moved. A vehicle that turns about what it looks at holds it on its pixel as well,
// but not to a fraction of a pixel, in most frames.
//
// Left out: what moves by itself; parts that only translation would tell.
#pragma once

#include "workload/next/foreign_matches.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

template <class P>
class FixedInView {
 public:
  /// @param state, inertial  outlive this
  /// @param memory  in L2, a byte for each cell
  FixedInView(const FrontEndState<P>& state, const InertialPart<P>& inertial, work::Arena& memory);

  /// Takes the matches with the last keyframe that lie in such parts off the list, and gives up the
  /// landmarks that they show.
  void drop_from(Frame<P>& frame);

 private:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  using Bytes = typename P::template L2Span<Byte>;

  enum class Verdict : std::uint8_t { Nothing, Stayed, Moved };

  Verdict verdict_on(const Frame<P>& frame, int match, const Mat3<P>& R_camera_keyframe) const;
  void take_evidence(const Frame<P>& frame);

  const FrontEndState<P>& state_;
  const InertialPart<P>& inertial_;
  PictureCells<P> cells_;
  Bytes evidence_;  ///< of each cell, from 0 to twice the limit
  I32 fixed_ = 0;   ///< cells that have reached the limit
};

}  // namespace leviosim::vio
