#include "workload/graph/visual_terms.h"

#include "workload/graph/landmark_records.h"
#include "workload/graph/linearisation.h"

namespace leviosim::vio {
namespace {

template <class P>
using Floats = typename P::template Span<typename P::F32>;

/// The landmark's own block of the normal equations: its damped inverse and right-hand side go to
/// the record.
/// @return false if the block cannot be inverted
template <class P>
bool invert_landmark(const LandmarkRecords<P>& records, int i, int number, typename P::F32 lambda) {
  using F = typename P::F32;
  const typename P::Code code("invert_landmark");
  Mat3<P> H = Mat3<P>::zero();
  Vec3<P> b{0.0f, 0.0f, 0.0f};
  for (int j : P::range(0, number)) {
    const auto slot = records.slot(i, j);
    for (int row = 0; row < 2; ++row) {
      const Vec3<P> J = load_vec3<P>(slot, LandmarkRecords<P>::kByPoint + 3 * row);
      const F residual = slot[LandmarkRecords<P>::kResidual + row];
      H.m[0][0] += J.x * J.x;
      H.m[0][1] += J.x * J.y;
      H.m[0][2] += J.x * J.z;
      H.m[1][1] += J.y * J.y;
      H.m[1][2] += J.y * J.z;
      H.m[2][2] += J.z * J.z;
      b.x -= J.x * residual;
      b.y -= J.y * residual;
      b.z -= J.z * residual;
    }
  }
  for (int d = 0; d < 3; ++d) H.m[d][d] += lambda * H.m[d][d];
  Mat3<P> inverse;
  if (!invert_spd3<P>(H, inverse)) return false;
  records.store_inverse(i, inverse);
  store_vec3<P>(records.own(i), LandmarkRecords<P>::kRightHandSide, b);
  return true;
}

/// A landmark that stays where it is.
template <class P>
void freeze_landmark(const LandmarkRecords<P>& records, int i) {
  const auto own = records.own(i);
  for (int e : P::range(0, LandmarkRecords<P>::kOwnFloats)) own[e] = 0.0f;
}

/// Leaves W = J_pᵀ J_l and Y = W H_ll⁻¹ of one observation, and adds -J_pᵀ r - Y b_l to the
/// right-hand side.
template <class P>
void form_coupling(const Floats<P>& slot, const Mat3<P>& inverse, const Vec3<P>& landmark_rhs,
                   const Floats<P>& rhs, const Floats<P>& W, const Floats<P>& Y) {
  using F = typename P::F32;
  const typename P::Code code("form_coupling");
  const Vec3<P> l0 = load_vec3<P>(slot, LandmarkRecords<P>::kByPoint);
  const Vec3<P> l1 = load_vec3<P>(slot, LandmarkRecords<P>::kByPoint + 3);
  const F r0 = slot[LandmarkRecords<P>::kResidual], r1 = slot[LandmarkRecords<P>::kResidual + 1];
  for (int r : P::range(0, 6)) {
    const F p0 = slot[LandmarkRecords<P>::kByPose + r],
            p1 = slot[LandmarkRecords<P>::kByPose + 6 + r];
    const Vec3<P> w = l0 * p0 + l1 * p1;
    const Vec3<P> y = inverse * w;  // the inverse is symmetric
    store_vec3<P>(W, 3 * r, w);
    store_vec3<P>(Y, 3 * r, y);
    F b = rhs[r];
    b -= p0 * r0;
    b -= p1 * r1;
    b -= F(dot(y, landmark_rhs));
    rhs[r] = b;
  }
}

// The 6×6 blocks below are updated row by row, three columns at a time. Of a block on the diagonal,
// what lies above the 3×3 blocks of the diagonal is left out: the matrix is symmetric. The number
// of columns is a template parameter, so that the compiler knows all bounds.

/// Row r of the block that add_pose_block() adds, its first 3·halves columns.
template <class P, int halves>
void add_pose_row(const Floats<P>& slot, int r, const Floats<P>& matrix, int row_begin) {
  using F = typename P::F32;
  const F p0 = slot[LandmarkRecords<P>::kByPose + r],
          p1 = slot[LandmarkRecords<P>::kByPose + 6 + r];
  for (int half : P::range(0, halves)) {
    const Vec3<P> q0 = load_vec3<P>(slot, LandmarkRecords<P>::kByPose + 3 * half);
    const Vec3<P> q1 = load_vec3<P>(slot, LandmarkRecords<P>::kByPose + 6 + 3 * half);
    const int at = row_begin + 3 * half;
    Vec3<P> sum = load_vec3<P>(matrix, at);
    sum.x += p0 * q0.x;
    sum.y += p0 * q0.y;
    sum.z += p0 * q0.z;
    sum.x += p1 * q1.x;
    sum.y += p1 * q1.y;
    sum.z += p1 * q1.z;
    store_vec3<P>(matrix, at, sum);
  }
}

/// matrix += J_pᵀ J_p of one observation, a block on the diagonal.
template <class P>
void add_pose_block(const Floats<P>& slot, const Floats<P>& matrix, int stride) {
  const typename P::Code code("add_pose_block");
  for (int r : P::range(0, 6)) {
    if (r < 3)
      add_pose_row<P, 1>(slot, r, matrix, r * stride);
    else
      add_pose_row<P, 2>(slot, r, matrix, r * stride);
  }
}

/// The first 3·halves columns of a row of matrix -= Y Wᵀ.
template <class P, int halves>
void subtract_row(const Vec3<P>& y, const Floats<P>& W, const Floats<P>& matrix, int row_begin) {
  for (int half : P::range(0, halves)) {
    const Mat3<P> w = load_mat3<P>(W, 9 * half);
    const int at = row_begin + 3 * half;
    Vec3<P> sum = load_vec3<P>(matrix, at);
    sum.x -= y.x * w.m[0][0];
    sum.y -= y.x * w.m[1][0];
    sum.z -= y.x * w.m[2][0];
    sum.x -= y.y * w.m[0][1];
    sum.y -= y.y * w.m[1][1];
    sum.z -= y.y * w.m[2][1];
    sum.x -= y.z * w.m[0][2];
    sum.y -= y.z * w.m[1][2];
    sum.z -= y.z * w.m[2][2];
    store_vec3<P>(matrix, at, sum);
  }
}

/// matrix -= Y Wᵀ, the block of two observations.
template <class P>
void subtract_elimination(const Floats<P>& Y, const Floats<P>& W, bool diagonal,
                          const Floats<P>& matrix, int stride) {
  const typename P::Code code("subtract_elimination");
  for (int r : P::range(0, 6)) {
    const Vec3<P> y = load_vec3<P>(Y, 3 * r);
    if (diagonal && r < 3)
      subtract_row<P, 1>(y, W, matrix, r * stride);
    else
      subtract_row<P, 2>(y, W, matrix, r * stride);
  }
}

/// Adds landmark i to the keyframes' equations. Its observations are in ascending order of
/// keyframes, so all blocks lie on or below the diagonal.
template <class P>
void eliminate_landmark(const Window<P>& window, const LandmarkRecords<P>& records, int i,
                        const EliminationScratch<P>& scratch, const ReducedSystem<P>& system) {
  using I32 = typename P::I32;
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  const Mat3<P> inverse = records.inverse(i);
  const Vec3<P> rhs = load_vec3<P>(records.own(i), LandmarkRecords<P>::kRightHandSide);
  const int stride = system.unknowns();
  for (int a : P::range(0, number)) {
    // uncounted: where a landmark's observations begin
    const I32 keyframe = window.observation_keyframes[first + a];
    const auto slot = records.slot(i, a);
    form_coupling<P>(slot, inverse, rhs, system.vector(keyframe), scratch.W.subspan(18 * a, 18),
                     scratch.Y);
    add_pose_block<P>(slot, system.block(keyframe, keyframe), stride);
    for (int b : P::range(0, a + 1)) {
      // uncounted: where a landmark's observations begin
      const I32 other = window.observation_keyframes[first + b];
      subtract_elimination<P>(scratch.Y, scratch.W.subspan(18 * b, 18), a == b,
                              system.block(keyframe, other), stride);
    }
  }
}

/// Step of landmark i: H_ll⁻¹ (b_l - Σ J_lᵀ J_p δ_p).
template <class P>
Vec3<P> landmark_step(const Window<P>& window, const LandmarkRecords<P>& records, int i,
                      const ReducedSystem<P>& solved) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  Vec3<P> b = load_vec3<P>(records.own(i), LandmarkRecords<P>::kRightHandSide);
  for (int j : P::range(0, number)) {
    const auto slot = records.slot(i, j);
    // uncounted: where a landmark's observations begin
    const auto step = solved.vector(I32(window.observation_keyframes[first + j]));
    const Vec3<P> turn = load_vec3<P>(step, 0), move = load_vec3<P>(step, 3);
    for (int row = 0; row < 2; ++row) {
      const int by_pose = LandmarkRecords<P>::kByPose + 6 * row;
      const F moved =
          F(dot(load_vec3<P>(slot, by_pose), turn)) + F(dot(load_vec3<P>(slot, by_pose + 3), move));
      b = b - load_vec3<P>(slot, LandmarkRecords<P>::kByPoint + 3 * row) * moved;
    }
  }
  return records.inverse(i) * b;
}

/// Cost of landmark i at `point`, seen from the keyframes of `state`.
template <class P>
LandmarkCost<P> landmark_cost(const Window<P>& window, const WindowState<P>& state, int i,
                              const Vec3<P>& point, const PixelModel<P>& model) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  LandmarkCost<P> sum{0.0f, false};
  for (int j : P::range(0, number)) {
    // uncounted: where a landmark's observations begin
    const Pose<P> T = pose_of<P>(state, window.observation_keyframes[first + j]);
    const Vec3<P> in_camera = transpose(T.R) * (point - T.t);
    Projection<P> at;
    if (project<P>(model, in_camera, observed_pixel<P>(window, first + j), at)) {
      sum.cost += huber_cost<P>(model, at.error_sq);
    } else {
      sum.cost += F(model.lost_cost);
      sum.lost = true;
    }
  }
  return sum;
}

}  // namespace

template <class P>
VisualUse add_visual_terms(work::Machine& machine, const Window<P>& window,
                           const PixelModel<P>& model, typename P::F32 lambda,
                           const LandmarkRecords<P>& all, const EliminationScratch<P>& scratch,
                           const ReducedSystem<P>& system, typename P::F32& cost) {
  using I32 = typename P::I32;
  const typename P::Function function("add_visual_terms");
  VisualUse use;
  const auto add = [&](const LandmarkRecords<P>& records, int begin, int end) {
    for (int i : P::range(begin, end)) {
      const I32 valid = linearise_landmark<P>(window, model, i, records, cost);
      const int number = work::value(I32(window.observation_numbers[i]));
      const bool usable = valid >= I32(2) && invert_landmark<P>(records, i, number, lambda);
      window.lost[i] = work::narrow<typename P::Byte>(I32(usable ? 0 : 1));
      if (!usable) {
        freeze_landmark<P>(records, i);
        continue;
      }
      eliminate_landmark<P>(window, records, i, scratch, system);
      ++use.landmarks;
      use.observations += work::value(valid);
    }
  };
  all.fill(machine, window.landmarks, window.landmarks, add);
  return use;
}

template <class P>
void step_points(work::Machine& machine, const Window<P>& window, const LandmarkRecords<P>& all,
                 const ReducedSystem<P>& solved, typename P::template Span<typename P::F32> to) {
  const typename P::Function function("step_points");
  all.read(machine, window.landmarks, [&](const LandmarkRecords<P>& records, int begin, int end) {
    for (int i : P::range(begin, end)) {
      const Vec3<P> point = load_vec3<P>(window.state.points, 3 * i);
      store_vec3<P>(to, 3 * i, point + landmark_step<P>(window, records, i, solved));
    }
  });
}

template <class P>
typename P::F32 settle_points(const Window<P>& window, const WindowState<P>& trial,
                              const PixelModel<P>& model) {
  const typename P::Function function("settle_points");
  return settle_by_cost<P>(window, trial, [&](int i, const Vec3<P>& point) {
    return landmark_cost<P>(window, trial, i, point, model);
  });
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template VisualUse add_visual_terms(                                                           \
      work::Machine&, const Window<P>&, const PixelModel<P>&, P::F32, const LandmarkRecords<P>&, \
      const EliminationScratch<P>&, const ReducedSystem<P>&, P::F32&);                           \
  template void step_points(work::Machine&, const Window<P>&, const LandmarkRecords<P>&,         \
                            const ReducedSystem<P>&, P::Span<P::F32>);                           \
  template P::F32 settle_points(const Window<P>&, const WindowState<P>&, const PixelModel<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
