#include "workload/levio/optimiser/levio_visual_terms.h"

#include <cstring>

#include "workload/graph/landmark_records.h"
#include "workload/graph/linearisation.h"
#include "workload/math/compilers.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {
namespace {

template <class P>
using Floats = typename P::template Span<typename P::F32>;

template <class P>
struct Sight {
  bool visible;
  Pose<P> T_world_camera;
  Projection<P> at;
  typename P::F32 error_px;
};

/// Where observation o shows a point, with the distance from where it was seen.
template <class P>
Sight<P> look(const Window<P>& window, const WindowState<P>& state, const PixelModel<P>& model,
              int o, const Vec3<P>& point) {
  Sight<P> sight;
  sight.T_world_camera = pose_of<P>(state, window.observation_keyframes[o]);
  const Pose<P>& T = sight.T_world_camera;
  const Vec3<P> in_camera = transpose(T.R) * (point - T.t);
  sight.visible = project<P>(model, in_camera, observed_pixel<P>(window, o), sight.at);
  sight.error_px = sight.visible ? work::sqrt(sight.at.error_sq) : typename P::F32(0.0f);
  return sight;
}

template <class P>
typename P::F32 cost_of(const PixelModel<P>& model, const Sight<P>& sight) {
  using F = typename P::F32;
  if (!sight.visible) return model.lost_cost;
  const F half = 0.5f;
  const F error = sight.error_px;
  if (error > model.huber) return model.information * model.huber * (error - half * model.huber);
  return model.information * (half * sight.at.error_sq);
}

/// Zeros, byte by byte, as the C library of the released program clears memory. Counted bytes are
/// no part of floats for the host's compiler, so they are cleared elsewhere and copied.
/// @param counted  as many bytes as the record has
template <class P>
void clear_record(typename P::template Span<typename P::Byte> counted, const Floats<P>& record) {
  using Byte = typename P::Byte;
  const typename P::Code code("levio_clear_record");
  const auto size = static_cast<std::size_t>(counted.size());
  if constexpr (P::kCounting) {
    for (int i : P::range(0, counted.size())) counted[i] = work::narrow<Byte>(typename P::I32(0));
    // uncounted: the loop above counts
    std::memcpy(static_cast<void*>(record.data()), counted.data(), size);
  } else {
    LEVIOSIM_TARGET_CLEAR(record.data(), 0, size);
  }
}

/// Fills the slots of landmark i. Lost observations keep their zeros.
/// @return the number of the others
template <class P>
typename P::I32 linearise(const Window<P>& window, const PixelModel<P>& model, int i,
                          const LandmarkRecords<P>& records, typename P::F32& cost) {
  using I32 = typename P::I32;
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  const Vec3<P> point = load_vec3<P>(window.state.points, 3 * i);
  I32 valid = 0;
  for (int j : P::range(0, number)) {
    const typename P::Code code("levio_linearise_observation");
    cost += cost_of<P>(model, look<P>(window, window.state, model, first + j, point));
    const Sight<P> again = look<P>(window, window.state, model, first + j, point);
    if (!again.visible) continue;
    store_term<P>(records.slot(i, j), vio::linearise<P>(model, again.T_world_camera.R, again.at));
    ++valid;
  }
  return valid;
}

/// The landmark's own block of the normal equations, all nine elements: its damped inverse and
/// right-hand side go to the record.
/// @return false if the block cannot be inverted
template <class P>
bool invert_landmark(const LandmarkRecords<P>& records, int i, int number, typename P::F32 lambda) {
  using F = typename P::F32;
  const typename P::Code code("levio_invert_landmark");
  Mat3<P> H = Mat3<P>::zero();
  F b[3] = {0.0f, 0.0f, 0.0f};
  for (int j : P::range(0, number)) {
    const auto slot = records.slot(i, j);
    for (int row = 0; row < 2; ++row) {
      const Vec3<P> by_point = load_vec3<P>(slot, LandmarkRecords<P>::kByPoint + 3 * row);
      const F J[3] = {by_point.x, by_point.y, by_point.z};
      const F residual = slot[LandmarkRecords<P>::kResidual + row];
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) H.m[r][c] += J[r] * J[c];
        b[r] -= J[r] * residual;
      }
    }
  }
  for (int d = 0; d < 3; ++d) H.m[d][d] = H.m[d][d] + lambda;
  Mat3<P> inverse;
  if (!invert_spd3<P>(H, inverse)) return false;
  records.store_inverse(i, inverse);
  store_vec3<P>(records.own(i), LandmarkRecords<P>::kRightHandSide, Vec3<P>{b[0], b[1], b[2]});
  return true;
}

/// J_pᵀ J_l of an observation, 6×3.
template <class P>
LEVIOSIM_HOST_INLINE void form_product(const Floats<P>& slot,
                                       typename P::template Array<typename P::F32, 18>& W) {
  using F = typename P::F32;
  const Vec3<P> l0 = load_vec3<P>(slot, LandmarkRecords<P>::kByPoint);
  const Vec3<P> l1 = load_vec3<P>(slot, LandmarkRecords<P>::kByPoint + 3);
  for (int r : P::range(0, 6)) {
    const F p0 = slot[LandmarkRecords<P>::kByPose + r],
            p1 = slot[LandmarkRecords<P>::kByPose + 6 + r];
    W[3 * r] = l0.x * p0 + l1.x * p1;
    W[3 * r + 1] = l0.y * p0 + l1.y * p1;
    W[3 * r + 2] = l0.z * p0 + l1.z * p1;
  }
}

template <class P>
Vec3<P> row_of(typename P::template Array<typename P::F32, 18>& W, int r) {
  using F = typename P::F32;
  return {F(W[3 * r]), F(W[3 * r + 1]), F(W[3 * r + 2])};
}

/// matrix −= W_a H_ll⁻¹ W_bᵀ, the block of two observations, whose products are formed for each of
/// its rows.
template <class P>
void subtract_elimination(const Floats<P>& slot_a, const Floats<P>& slot_b, const Mat3<P>& inverse,
                          const Floats<P>& matrix, int stride) {
  const typename P::Function function("levio_subtract_elimination");
  typename P::template Array<typename P::F32, 18> W_a, W_b;
  for (int r : P::range(0, 6)) {
    form_product<P>(slot_a, W_a);
    form_product<P>(slot_b, W_b);
    const Vec3<P> y = inverse * row_of<P>(W_a, r);  // the inverse is symmetric
    for (int c : P::range(0, 6))
      matrix[r * stride + c] -= typename P::F32(dot(y, row_of<P>(W_b, c)));
  }
}

/// matrix += J_pᵀ J_p of one observation, and its part of the right-hand side.
template <class P>
void add_observation(const Floats<P>& slot, const Mat3<P>& inverse, const Vec3<P>& landmark_rhs,
                     const Floats<P>& matrix, int stride, const Floats<P>& rhs) {
  using F = typename P::F32;
  const typename P::Function function("levio_add_observation");
  typename P::template Array<F, 18> W;
  form_product<P>(slot, W);
  const F r0 = slot[LandmarkRecords<P>::kResidual], r1 = slot[LandmarkRecords<P>::kResidual + 1];
  for (int r : P::range(0, 6)) {
    const F p0 = slot[LandmarkRecords<P>::kByPose + r],
            p1 = slot[LandmarkRecords<P>::kByPose + 6 + r];
    for (int c : P::range(0, 6)) {
      F sum = matrix[r * stride + c];
      sum += p0 * slot[LandmarkRecords<P>::kByPose + c];
      sum += p1 * slot[LandmarkRecords<P>::kByPose + 6 + c];
      matrix[r * stride + c] = sum;
    }
    F b = rhs[r];
    b -= p0 * r0;
    b -= p1 * r1;
    b -= F(dot(inverse * row_of<P>(W, r), landmark_rhs));
    rhs[r] = b;
  }
}

/// Adds landmark i to the keyframes' equations.
template <class P>
void eliminate_landmark(const Window<P>& window, const LandmarkRecords<P>& records, int i,
                        const ReducedSystem<P>& system) {
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
    add_observation<P>(slot, inverse, rhs, system.block(keyframe, keyframe), stride,
                       system.vector(keyframe));
    for (int b : P::range(0, number)) {
      // uncounted: where a landmark's observations begin
      const I32 other = window.observation_keyframes[first + b];
      subtract_elimination<P>(slot, records.slot(i, b), inverse, system.block(keyframe, other),
                              stride);
    }
  }
}

/// Cost of landmark i at `point`, seen from the keyframes of `state`.
template <class P>
LandmarkCost<P> landmark_cost(const Window<P>& window, const WindowState<P>& state, int i,
                              const Vec3<P>& point, const PixelModel<P>& model) {
  using I32 = typename P::I32;
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  LandmarkCost<P> sum{0.0f, false};
  for (int j : P::range(0, number)) {
    const Sight<P> sight = look<P>(window, state, model, first + j, point);
    sum.cost += cost_of<P>(model, sight);
    sum.lost = sum.lost || !sight.visible;
  }
  return sum;
}

}  // namespace

template <class P>
VisualUse add_visual_terms(work::Machine& machine, const Window<P>& window,
                           const PixelModel<P>& model, typename P::F32 lambda,
                           const LandmarkRecords<P>& all,
                           typename P::template Span<typename P::Byte> cleared,
                           const ReducedSystem<P>& system, typename P::F32& cost) {
  using I32 = typename P::I32;
  const typename P::Function function("levio_add_visual_terms");
  VisualUse use;
  const auto add = [&](const LandmarkRecords<P>& records, int begin, int end) {
    for (int i : P::range(begin, end)) {
      clear_record<P>(cleared, records.record(i));
      if (I32(i) >= I32(window.landmarks)) continue;
      const I32 valid = linearise<P>(window, model, i, records, cost);
      const int number = work::value(I32(window.observation_numbers[i]));
      const bool usable = valid >= I32(2) && invert_landmark<P>(records, i, number, lambda);
      window.lost[i] = work::narrow<typename P::Byte>(I32(usable ? 0 : 1));
      if (!usable) continue;
      eliminate_landmark<P>(window, records, i, system);
      ++use.landmarks;
      use.observations += work::value(valid);
    }
  };
  all.fill(machine, window.capacity.landmarks, window.landmarks, add);
  return use;
}

template <class P>
typename P::F32 settle_points(const Window<P>& window, const WindowState<P>& trial,
                              const PixelModel<P>& model) {
  const typename P::Function function("levio_settle_points");
  return settle_by_cost<P>(window, trial, [&](int i, const Vec3<P>& point) {
    return landmark_cost<P>(window, trial, i, point, model);
  });
}

#define LEVIOSIM_INSTANTIATE(P)                                                               \
  template VisualUse add_visual_terms(work::Machine&, const Window<P>&, const PixelModel<P>&, \
                                      P::F32, const LandmarkRecords<P>&, P::Span<P::Byte>,    \
                                      const ReducedSystem<P>&, P::F32&);                      \
  template P::F32 settle_points(const Window<P>&, const WindowState<P>&, const PixelModel<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio::levio
