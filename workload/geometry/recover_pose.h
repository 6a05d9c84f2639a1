// The relative pose of two views from their essential matrix (PARAMETERS.md#pose-recovery):
// of the four poses that an essential matrix admits, the one that puts most matches in front of
// both cameras, decided by triangulating them. One fork per pose; the cores share the matches.
//
// Left out: the length of the translation, which two views do not tell. It comes out as 1.
#pragma once

#include "sim/work/machine.h"
#include "workload/geometry/eight_point.h"
#include "workload/geometry/triangulate.h"

namespace leviosim::vio {

struct RecoverPoseOptions {
  TriangulationOptions triangulation;
  int max_svd_rotations = 10;
  DiagonalPrecision svd_precision = DiagonalPrecision::Double;
};

template <class P>
struct TwoViewPose {
  bool ok;        ///< false if no match lies in front of both cameras for any pose
  Pose<P> T_b_a;  ///< |t| = 1; identity if not ok
  int in_front;   ///< matches in front of both cameras
};

/// The four poses T_b_a with E = ± [t]× R and |t| = 1.
template <class P>
struct FourPoses {
  Pose<P> T_b_a[4];
};
template <class P>
FourPoses<P> decompose_essential(const Mat3<P>& E, const RecoverPoseOptions& options = {});

/// @param mask  one element per match, 0 for those to leave out; or an empty view to use them all
template <class P>
TwoViewPose<P> recover_pose(work::Machine& machine, const TwoViewMatches<P>& matches,
                            typename P::template Span<const typename P::Byte> mask,
                            const Mat3<P>& E, const RecoverPoseOptions& options = {});

}  // namespace leviosim::vio
