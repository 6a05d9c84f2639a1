// The reduced normal equations of the window: keyframes only, landmarks eliminated. Symmetric; only
// the lower triangle is kept, as Cholesky needs it. 72 unknowns for 8 keyframes with IMU: rotation
// 3, position 3, velocity 3 each; without IMU there are no velocities and 48 unknowns.
#pragma once

#include "workload/inertial/record.h"
#include "workload/inertial/record_sums.h"
#include "workload/inertial/residual.h"
#include "workload/math/matrix.h"
#include "workload/math/solve.h"

namespace leviosim::vio {

/// Weight 1/σ² of what is known with a standard deviation; 0 if it is free (σ = 0).
inline float information(float stddev) { return stddev > 0 ? 1.0f / (stddev * stddev) : 0.0f; }

template <class P>
class ReducedSystem {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Span = typename P::template Span<F>;

  static constexpr int kPoseUnknowns = 6;
  static constexpr int kPoseAndVelocityUnknowns = 9;

  /// @param shared  unknowns that belong to no keyframe; they come last
  ReducedSystem(work::Arena& arena, int keyframes, bool with_velocities, int shared = 0)
      : ReducedSystem(arena, with_velocities ? kPoseAndVelocityUnknowns : kPoseUnknowns,
                      keyframes * (with_velocities ? kPoseAndVelocityUnknowns : kPoseUnknowns),
                      shared) {}

  int unknowns() const { return matrix_.rows(); }
  int per_keyframe() const { return per_keyframe_; }
  /// Place of the first shared unknown.
  int shared() const { return shared_; }
  MatrixView<P> matrix() const { return matrix_; }
  /// Right-hand side, and after solve() the step.
  Span vector() const { return vector_; }
  /// Element c of row r of the block of keyframes (a, b), at [r * unknowns() + c].
  Span block(I32 a, I32 b) const {
    const I32 n = unknowns(), d = per_keyframe_;
    const I32 row = a * d;
    const I32 at = row * n + b * d;
    return matrix_.data().subspan(at, (per_keyframe_ - 1) * unknowns() + per_keyframe_);
  }
  Span vector(I32 keyframe) const {
    const I32 at = keyframe * I32(per_keyframe_);
    return vector_.subspan(at, per_keyframe_);
  }

  void clear() const {
    fill<P>(matrix_, 0.0f);
    for (int i : P::range(0, unknowns())) vector_[i] = 0.0f;
  }

  /// Levenberg-Marquardt damping: the diagonal grows by the factor 1 + λ. An unknown that no
  /// residual touches stays where it is.
  void damp(F lambda) const {
    for (int i : P::range(0, unknowns())) {
      const F diagonal = matrix_(i, i);
      F damped = diagonal + lambda * diagonal;
      if (!(damped > 0.0f)) damped = 1.0f;
      matrix_(i, i) = damped;
    }
  }

  /// Replaces the right-hand side by the solution, and the matrix by its factor.
  /// @return false if the matrix is not positive definite
  bool solve() const {
    if (!cholesky_factor<P>(matrix_)) return false;
    cholesky_solve<P>(matrix_, vector_);
    return true;
  }

  /// The state of keyframe k, moved by its part of the step.
  KeyframeState<P> moved(KeyframeState<P> state, int k) const {
    const int at = k * per_keyframe_;
    Pose<P>& T = state.T_world_camera;
    T.R = orthonormalised<P>(T.R * so3_exp<P>(load_vec3<P>(vector_, at)));
    T.t = T.t + load_vec3<P>(vector_, at + 3);
    if (per_keyframe_ == kPoseAndVelocityUnknowns)
      state.velocity = state.velocity + load_vec3<P>(vector_, at + 6);
    return state;
  }

 private:
  ReducedSystem(work::Arena& arena, int per_keyframe, int of_keyframes, int shared)
      : per_keyframe_(per_keyframe),
        shared_(of_keyframes),
        matrix_(
            alloc_matrix<P>(arena, "reduced system", of_keyframes + shared, of_keyframes + shared)),
        vector_(arena.alloc<Span>("reduced right-hand side", of_keyframes + shared)) {}

  int per_keyframe_;
  int shared_;
  MatrixView<P> matrix_;
  Span vector_;
};

}  // namespace leviosim::vio
