// The optimiser's work memory: one record of Jacobian blocks per landmark (paper section IV.B,
// "Optimizer" in its memory table: up to 743.6 kB of L2).
//
// A record has a slot for each keyframe of the window, used for the landmark's observations in
// their order, and the landmark's own block:
//   per slot   2×6 derivative by the pose (rotation, position), 2×3 derivative by the landmark,
//              2 residuals: 80 bytes
//   at the end the inverse of the landmark's block of the normal equations (6, symmetric) and its
//              right-hand side (3): 36 bytes
// For 8 keyframes and 1000 landmarks 676 kB.
#pragma once

namespace leviosim::vio {

template <class P>
class LandmarkRecords {
 public:
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  // Places in a slot.
  static constexpr int kByPose = 0;    ///< two rows of 6
  static constexpr int kByPoint = 12;  ///< two rows of 3
  static constexpr int kResidual = 18;
  static constexpr int kSlotFloats = 20;
  // Places in the landmark's own block.
  static constexpr int kInverse = 0;
  static constexpr int kRightHandSide = 6;
  static constexpr int kOwnFloats = 9;

  LandmarkRecords(work::Arena& arena, int landmarks, int keyframes)
      : floats_(keyframes * kSlotFloats + kOwnFloats),
        keyframes_(keyframes),
        memory_(arena.alloc<Span>("landmark Jacobian records", landmarks * floats_)) {}

  /// Floats of a record.
  int floats() const { return floats_; }
  Span record(int i) const { return memory_.subspan(i * floats_, floats_); }
  /// Slot of the j-th observation of landmark i.
  Span slot(int i, int j) const {
    return memory_.subspan(i * floats_ + j * kSlotFloats, kSlotFloats);
  }
  /// Landmark i's own block.
  Span own(int i) const {
    return memory_.subspan(i * floats_ + keyframes_ * kSlotFloats, kOwnFloats);
  }

  void store_inverse(int i, const Mat3<P>& inverse) const {
    const Span to = own(i);
    int at = kInverse;
    for (int r = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c) to[at++] = inverse.m[r][c];
  }
  Mat3<P> inverse(int i) const {
    const Span from = own(i);
    const F xx = from[0], xy = from[1], xz = from[2], yy = from[3], yz = from[4], zz = from[5];
    return {{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  }

 private:
  int floats_;
  int keyframes_;
  Span memory_;
};

}  // namespace leviosim::vio
