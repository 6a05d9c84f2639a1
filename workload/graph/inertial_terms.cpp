#include "workload/graph/inertial_terms.h"

#include "workload/graph/interval_rows.h"

namespace leviosim::vio {
namespace {

using namespace interval;

constexpr int kResidual = 18;  ///< column of the residual

template <class P>
void store_jacobians(MatrixView<P> rows, const ImuJacobians<P>& J, typename P::F32 dt) {
  using F = typename P::F32;
  const Mat3<P> minus_Rt = scaled<P>(F(-1.0f), J.Rt);
  store_block<P>(rows, kRotationRow, 0, J.rotation_by_rotation0);
  store_block<P>(rows, kRotationRow, kEnd, J.rotation_by_rotation1);
  store_block<P>(rows, kVelocityRow, 0, J.velocity_by_rotation0);
  store_block<P>(rows, kVelocityRow, kVelocityColumn, minus_Rt);
  store_block<P>(rows, kVelocityRow, kEnd + kVelocityColumn, J.Rt);
  store_block<P>(rows, kPositionRow, 0, J.position_by_rotation0);
  store_block<P>(rows, kPositionRow, kPositionColumn, minus_Rt);
  store_block<P>(rows, kPositionRow, kVelocityColumn, scaled<P>(dt, minus_Rt));
  store_block<P>(rows, kPositionRow, kEnd + kPositionColumn, J.Rt);
}

/// The columns of two consecutive keyframes are neighbours in the system.
template <class P>
void add_rows(MatrixView<P> rows, const ReducedSystem<P>& system, int keyframe) {
  using F = typename P::F32;
  const typename P::Function function("add_rows");
  const int base = keyframe * system.per_keyframe();
  const MatrixView<P> matrix = system.matrix();
  for (int i : P::range(0, kResidual)) {
    for (int j : P::range(0, i + 1)) {
      F sum = matrix(base + i, base + j);
      for (int r : P::range(0, 9)) sum += rows(r, i) * rows(r, j);
      matrix(base + i, base + j) = sum;
    }
    F b = system.vector()[base + i];
    for (int r : P::range(0, 9)) b -= rows(r, i) * rows(r, kResidual);
    system.vector()[base + i] = b;
  }
}

template <class P>
struct AnchorResidual {
  Vec3<P> rotation, position, velocity;
};

template <class P>
AnchorResidual<P> anchor_residual(const Window<P>& window, const WindowState<P>& state) {
  const KeyframeState<P> oldest = state.keyframe(0);
  const Pose<P>& anchor = window.anchor.T_world_camera;
  return {so3_log<P>(transpose(anchor.R) * oldest.T_world_camera.R),
          oldest.T_world_camera.t - anchor.t, oldest.velocity - window.anchor.velocity};
}

template <class P>
float velocity_information(const Window<P>& window, const AnchorOptions& options) {
  using I32 = typename P::I32;
  const bool first_of_all = bool(I32(window.keyframe_ids[0]) == I32(0));
  return information(first_of_all ? options.initial_velocity : options.velocity);
}

template <class P>
void add_held(const ReducedSystem<P>& system, int at, const Vec3<P>& residual, float weight) {
  using F = typename P::F32;
  const F w = weight;
  const MatrixView<P> matrix = system.matrix();
  for (int i = 0; i < 3; ++i) matrix(at + i, at + i) += w;
  const auto b = system.vector();
  b[at] -= w * residual.x;
  b[at + 1] -= w * residual.y;
  b[at + 2] -= w * residual.z;
}

template <class P>
typename P::F32 held_cost(const AnchorResidual<P>& r, const AnchorOptions& options,
                          float of_velocity) {
  using F = typename P::F32;
  F cost = F(dot(r.rotation, r.rotation)) * F(0.5f * information(options.rotation));
  cost += F(dot(r.position, r.position)) * F(0.5f * information(options.position));
  if (of_velocity > 0) cost += F(dot(r.velocity, r.velocity)) * F(0.5f * of_velocity);
  return cost;
}

}  // namespace

template <class P>
typename P::F32 add_inertial_terms(const Window<P>& window, const IntervalScratch<P>& scratch,
                                   const ReducedSystem<P>& system) {
  using F = typename P::F32;
  const typename P::Function function("add_inertial_terms");
  F cost = 0.0f;
  for (int k : P::range(1, window.keyframes)) {
    const Preintegration<P> interval = window.interval(k);
    if (!(interval.duration() > 0.0f)) continue;
    const KeyframeState<P> begin = window.state.keyframe(k - 1), end = window.state.keyframe(k);
    const ImuDelta<P> delta = interval.corrected(window.bias);
    const ImuResidual<P> residual = imu_residual<P>(begin, end, delta, window.gravity);
    fill<P>(scratch.rows, 0.0f);
    store_residual<P>(scratch.rows, residual);
    store_jacobians<P>(scratch.rows,
                       imu_jacobians<P>(begin, end, delta.dt, window.gravity, residual), delta.dt);
    whiten<P>(interval, scratch.rows, 0, IntervalScratch<P>::kColumns);
    add_rows<P>(scratch.rows, system, k - 1);
    cost += half_square_of_residual<P>(scratch.rows);
  }
  return cost;
}

template <class P>
typename P::F32 inertial_cost(const Window<P>& window, const WindowState<P>& state,
                              const IntervalScratch<P>& scratch) {
  using F = typename P::F32;
  const typename P::Function function("inertial_cost");
  F cost = 0.0f;
  for (int k : P::range(1, window.keyframes)) {
    const Preintegration<P> interval = window.interval(k);
    if (!(interval.duration() > 0.0f)) continue;
    store_residual<P>(scratch.rows,
                      imu_residual<P>(state.keyframe(k - 1), state.keyframe(k),
                                      interval.corrected(window.bias), window.gravity));
    whiten<P>(interval, scratch.rows, kResidual, kResidual + 1);
    cost += half_square_of_residual<P>(scratch.rows);
  }
  return cost;
}

template <class P>
typename P::F32 add_anchor(const Window<P>& window, const AnchorOptions& options,
                           const ReducedSystem<P>& system) {
  const typename P::Function function("add_anchor");
  const bool with_velocity = system.per_keyframe() > kVelocityColumn;
  const AnchorResidual<P> r = anchor_residual<P>(window, window.state);
  add_held<P>(system, 0, r.rotation, information(options.rotation));
  add_held<P>(system, kPositionColumn, r.position, information(options.position));
  const float of_velocity = with_velocity ? velocity_information<P>(window, options) : 0.0f;
  if (with_velocity) add_held<P>(system, kVelocityColumn, r.velocity, of_velocity);
  return held_cost<P>(r, options, of_velocity);
}

template <class P>
typename P::F32 anchor_cost(const Window<P>& window, const WindowState<P>& state,
                            const AnchorOptions& options, bool with_velocity) {
  const typename P::Function function("anchor_cost");
  return held_cost<P>(anchor_residual<P>(window, state), options,
                      with_velocity ? velocity_information<P>(window, options) : 0.0f);
}

#define LEVIOSIM_INSTANTIATE(P)                                                                \
  template P::F32 add_inertial_terms(const Window<P>&, const IntervalScratch<P>&,              \
                                     const ReducedSystem<P>&);                                 \
  template P::F32 inertial_cost(const Window<P>&, const WindowState<P>&,                       \
                                const IntervalScratch<P>&);                                    \
  template P::F32 add_anchor(const Window<P>&, const AnchorOptions&, const ReducedSystem<P>&); \
  template P::F32 anchor_cost(const Window<P>&, const WindowState<P>&, const AnchorOptions&, bool);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
