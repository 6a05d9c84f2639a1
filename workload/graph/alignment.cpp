#include "workload/graph/alignment.h"

#include <algorithm>
#include <array>

#include "workload/graph/anchored_landmarks.h"
#include "workload/graph/carried_poses.h"
#include "workload/graph/reduced_system.h"
#include "workload/inertial/initialisation.h"

namespace leviosim::vio {
namespace {

/// Places of the unknowns.
constexpr int kVelocity = 0, kGravityAt = 3, kGyro = 6, kAccel = 9;

/// Standard deviations from the minimum at which an alignment is there.
constexpr float kArrived = 0.1f;

/// The window's state as what the IMU carries its first keyframe from.
template <class P>
CarriedFrom<P> start_of(const Window<P>& window) {
  const KeyframeState<P> first = window.state.keyframe(0);
  const Mat3<P> R_camera_world = transpose(first.T_world_camera.R);
  return {R_camera_world * first.velocity, R_camera_world * window.gravity, window.bias};
}

/// The keyframes of the window where they were carried to. The first one is turned so that gravity
/// points down.
template <class P>
void place_keyframes(const CarriedPoses<P>& poses, const CarriedFrom<P>& from, Window<P>& window) {
  Pose<P> T_world_first = window.state.pose(0);
  T_world_first.R = levelled<P>(orthonormalised<P>(T_world_first.R), -from.gravity);
  for (int k : P::range(0, window.keyframes)) {
    const CarriedPose<P> at = poses[k];
    window.state.set_keyframe(k, {T_world_first * Pose<P>{orthonormalised<P>(at.R), at.p},
                                  T_world_first.R * at.velocity});
  }
  window.bias = from.bias;
  window.bias_is_new = true;
}

/// Mean specific force over the window, which gravity opposes but for the mean acceleration.
template <class P>
Vec3<P> mean_force_of(const CarriedPoses<P>& poses, const CarriedFrom<P>& from, int last) {
  using F = typename P::F32;
  const CarriedPose<P> end = poses[last];
  return (end.velocity - from.velocity) * F(F(1.0f) / end.time) - from.gravity;
}

/// Nothing is known: no velocity, no biases but those of the prior, and gravity opposes the mean
/// force.
template <class P>
CarriedFrom<P> unknown_start(const Window<P>& window, const CarriedPoses<P>& scratch) {
  using F = typename P::F32;
  CarriedFrom<P> from = start_of<P>(window);
  from.velocity = {0.0f, 0.0f, 0.0f};
  from.bias = window.bias_prior.mean;
  carry<P>(window, from, scratch);
  const Vec3<P> force = mean_force_of<P>(scratch, from, window.keyframes - 1);
  from.gravity = force * F(F(-kGravity) / norm(force));
  return from;
}

/// What is known apart from the images, at `from`.
/// @param first  the gyro's bias is held as for the first window
template <class P>
typename P::F32 add_knowledge(const Window<P>& window, const CarriedPoses<P>& poses,
                              const CarriedFrom<P>& from, const OptimiserOptions& optimiser,
                              const AlignmentOptions& options, bool first,
                              const ReducedSystem<P>* system) {
  using F = typename P::F32;
  F cost = 0.0f;
  const auto hold = [&](int at, const Vec3<P>& off, float stddev) {
    const F weight = information(stddev);
    cost += F(0.5f) * weight * dot(off, off);
    if (system == nullptr) return;
    const F offs[3] = {off.x, off.y, off.z};
    for (int i = 0; i < 3; ++i) {
      system->matrix()(at + i, at + i) += weight;
      system->vector()[at + i] -= weight * offs[i];
    }
  };
  hold(kVelocity, from.velocity, options.velocity);
  hold(kGravityAt, from.gravity + mean_force_of<P>(poses, from, window.keyframes - 1),
       options.acceleration);
  hold(kGyro, from.bias.gyro - window.bias_prior.mean.gyro,
       first ? options.first_gyro_bias : optimiser.prior.gyro_bias);
  hold(kAccel, from.bias.accel - window.bias_prior.mean.accel, optimiser.prior.accel_bias);
  return cost;
}

/// Gravity keeps its length: it moves on its sphere.
template <class P>
void hold_length(const Vec3<P>& gravity, const ReducedSystem<P>& system) {
  using F = typename P::F32;
  constexpr float kStddev = 1e-3f;  // m/s², of the length
  const F weight = F(information(kStddev)) / dot(gravity, gravity);
  const F g[3] = {gravity.x, gravity.y, gravity.z};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c)
      system.matrix()(kGravityAt + r, kGravityAt + c) += weight * g[r] * g[c];
}

template <class P>
CarriedFrom<P> stepped(const CarriedFrom<P>& from, const ReducedSystem<P>& solved) {
  using F = typename P::F32;
  const auto step = solved.vector();
  const Vec3<P> gravity = from.gravity + load_vec3<P>(step, kGravityAt);
  return {
      from.velocity + load_vec3<P>(step, kVelocity),
      gravity * F(F(kGravity) / norm(gravity)),
      {from.bias.gyro + load_vec3<P>(step, kGyro), from.bias.accel + load_vec3<P>(step, kAccel)}};
}

/// The variance of a keyframe's position, m².
/// @param factor  of the information of the unknowns
template <class P>
typename P::F32 variance_of_position(const CarriedPose<P>& at, MatrixView<P> factor,
                                     typename P::template Span<typename P::F32> column) {
  using F = typename P::F32;
  const F half_square = at.time * at.time * F(0.5f);
  F variance = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i : P::range(0, kAlignmentUnknowns)) column[i] = 0.0f;
    column[kVelocity + axis] = at.time;
    column[kGravityAt + axis] = half_square;
    store_vec3<P>(column, kGyro, at.p_by_gyro.row(axis));
    store_vec3<P>(column, kAccel, at.p_by_accel.row(axis));
    variance += square_by_inverse<P>(factor, column);
  }
  return variance;
}

/// How uncertain the keyframes' positions are, as a share of their distances from the first one.
template <class P>
typename P::F32 uncertainty_of_positions(const CarriedPoses<P>& poses, int keyframes,
                                         MatrixView<P> factor,
                                         typename P::template Span<typename P::F32> column) {
  using F = typename P::F32;
  F variance = 0.0f, square = 0.0f;
  for (int k : P::range(1, keyframes)) {
    const CarriedPose<P> at = poses[k];
    variance += variance_of_position<P>(at, factor, column);
    square += dot(at.p, at.p);
  }
  return work::sqrt(F(variance / work::max(F(square), F(1e-6f))));
}

/// RMS distance of the keyframes from the first one, m.
template <class P>
typename P::F32 length_of(const CarriedPoses<P>& poses, int keyframes) {
  using F = typename P::F32;
  F square = 0.0f;
  for (int k : P::range(1, keyframes)) {
    const CarriedPose<P> at = poses[k];
    square += dot(at.p, at.p);
  }
  return work::sqrt(F(square / F(static_cast<float>(keyframes))));
}

/// Whether it is near its minimum, and can be true.
/// @param knowledge  the cost of what is known apart from the images
template <class P>
bool has_converged(const Window<P>& window, const AlignmentReport& report, float knowledge,
                   const AlignmentOptions& options) {
  return 2 * knowledge < options.max_prior_deviation * options.max_prior_deviation &&
         static_cast<float>(report.explained) >=
             options.min_explained * static_cast<float>(window.landmarks) &&
         report.distance < options.max_distance;
}

/// Whether the window tells enough.
template <class P>
bool is_determined(const Window<P>& window, const AlignmentReport& report,
                   const AlignmentOptions& options) {
  const bool full = window.keyframes == window.capacity.keyframes;
  const float limit = options.max_uncertainty * (full ? options.full_uncertainty : 1.0f);
  return report.converged && window.keyframes > options.few_keyframes &&
         report.uncertainty < limit && report.landmarks >= options.min_landmarks;
}

/// What an iteration begins from.
enum class Begin {
  here,               ///< the window's state
  without_landmarks,  ///< that of the first keyframe and the biases, with landmarks at the mean
  afresh              ///< nothing but landmarks at the mean
};

template <class P>
AlignmentReport iterate(work::Machine& fc, Window<P>& window, AlignmentState<P>& state,
                        const OptimiserOptions& optimiser, const AlignmentOptions& options,
                        Begin begin) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("align_once");
  const bool afresh = begin == Begin::afresh;
  AlignmentReport report;
  report.lambda = work::value(state.lambda);
  if (window.keyframes < 2) return report;
  work::Arena& arena = fc.local();
  const work::Arena::Frame frame(arena);
  const CarriedPoses<P> poses(arena, window.keyframes), trial_poses(arena, window.keyframes);
  const ReducedSystem<P> system(arena, 0, false, kAlignmentUnknowns);
  const MatrixView<P> factor = alloc_matrix<P>(arena, "information of the alignment",
                                               kAlignmentUnknowns, kAlignmentUnknowns);
  const auto slope = arena.alloc<Span>("slope of the alignment", kAlignmentUnknowns);
  const auto column = arena.alloc<Span>("column of the alignment", kAlignmentUnknowns);
  const bool first = afresh || window.keyframes <= options.few_keyframes;
  AnchoredLandmarks<P> landmarks(arena, window, PixelModel<P>(optimiser.visual),
                                 state.inverse_depth,
                                 first ? options.first_spread : options.spread);
  const auto trial = arena.alloc<Span>("trial landmarks", 3 * window.landmarks);

  const CarriedFrom<P> from = afresh ? unknown_start<P>(window, poses) : start_of<P>(window);
  if (begin == Begin::here)
    landmarks.anchor(window);
  else
    landmarks.aim(window);
  carry<P>(window, from, poses);
  landmarks.settle(window, poses, landmarks.all());
  system.clear();
  F cost = landmarks.add(window, poses, system);
  cost += add_knowledge<P>(window, poses, from, optimiser, options, first, &system);
  hold_length<P>(from.gravity, system);
  copy<P>(factor, system.matrix());
  for (int i : P::range(0, kAlignmentUnknowns)) slope[i] = F(system.vector()[i]);
  system.damp(state.lambda);
  const F mean = landmarks.mean();
  F trial_cost = cost;
  CarriedFrom<P> to = from;
  report.positive_definite = system.solve();
  if (report.positive_definite) {
    to = stepped<P>(from, system);
    // Half of it at least: a mean is not negative.
    landmarks.set_mean(
        work::max(F(mean + F(system.vector()[kMeanInverseDepth])), F(mean * F(0.5f))));
    carry<P>(window, to, trial_poses);
    for (int i : P::range(0, 3 * window.landmarks)) trial[i] = F(landmarks.all()[i]);
    trial_cost = landmarks.settle(window, trial_poses, trial);
    trial_cost += add_knowledge<P>(window, trial_poses, to, optimiser, options, first, nullptr);
  }
  report.accepted = bool(trial_cost < cost);
  if (report.accepted) {
    for (int i : P::range(0, 3 * window.landmarks)) landmarks.all()[i] = F(trial[i]);
    place_keyframes<P>(trial_poses, to, window);
    state.lambda = work::max(F(state.lambda * optimiser.lambda_down), F(optimiser.min_lambda));
  } else {
    place_keyframes<P>(poses, from, window);
    landmarks.set_mean(mean);
    state.lambda = work::min(F(state.lambda * optimiser.lambda_up), F(optimiser.max_lambda));
  }
  state.inverse_depth = landmarks.mean();
  const CarriedPoses<P>& best = report.accepted ? trial_poses : poses;
  const auto verdict = landmarks.judge(window, best);
  report.landmarks = verdict.observable;
  report.explained = verdict.explained;
  landmarks.release(window);
  report.cost_before = work::value(cost);
  report.cost_after = work::value(trial_cost);
  if (!cholesky_factor<P>(factor)) return report;
  report.distance = work::value(work::sqrt(square_by_inverse<P>(factor, slope)));
  report.arrived = report.distance < kArrived;
  report.uncertainty =
      work::value(uncertainty_of_positions<P>(best, window.keyframes, factor, column));
  report.length = work::value(length_of<P>(best, window.keyframes));
  const F knowledge = add_knowledge<P>(window, best, report.accepted ? to : from, optimiser,
                                       options, first, nullptr);
  report.converged = has_converged<P>(window, report, work::value(knowledge), options);
  report.determined = is_determined<P>(window, report, options);
  return report;
}

/// Some landmarks of a window, evenly over all, with a state of their own: enough to compare
/// starts.
template <class P>
Window<P> share_of(work::Arena& arena, const Window<P>& window) {
  constexpr int kMost = 100;
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;
  using Floats = typename P::template Span<F>;
  const int step = std::max(1, (window.landmarks + kMost - 1) / kMost);
  Window<P> share = window;
  share.landmarks = (window.landmarks + step - 1) / step;
  const auto numbers =
      arena.alloc<typename P::template Span<U16>>("share: first observations", share.landmarks);
  const auto bytes = arena.alloc<typename P::template Span<Byte>>("share: numbers and losses",
                                                                  2 * share.landmarks);
  share.state = {arena.alloc<Floats>("share: poses", kPoseFloats * window.keyframes),
                 arena.alloc<Floats>("share: velocities", 3 * window.keyframes),
                 arena.alloc<Floats>("share: points", 3 * share.landmarks)};
  share.first_observations = numbers;
  share.observation_numbers = bytes.subspan(0, share.landmarks);
  share.lost = bytes.subspan(share.landmarks, share.landmarks);
  for (int k : P::range(0, window.keyframes)) share.state.set_keyframe(k, window.state.keyframe(k));
  for (int i : P::range(0, share.landmarks)) {
    const int of = step * i;
    numbers[i] = work::narrow<U16>(I32(window.first_observations[of]));
    share.observation_numbers[i] = work::narrow<Byte>(I32(window.observation_numbers[of]));
    store_vec3<P>(share.state.points, 3 * i, load_vec3<P>(window.state.points, 3 * of));
  }
  return share;
}

/// Inverse depths to begin from, 1/m: what is seen is 0.3 to 30 m away.
constexpr std::array kStarts = {3.0f, 1.0f, 0.3f, 0.1f, 0.03f};

/// Whether the two are one solution, but for what is left to iterate.
bool same_scale(const AlignmentReport& a, const AlignmentReport& b,
                const AlignmentOptions& options) {
  return a.length < options.same_scale * b.length && b.length < options.same_scale * a.length;
}

}  // namespace

template <class P>
AlignmentReport align_once(work::Machine& fc, Window<P>& window, AlignmentState<P>& state,
                           const OptimiserOptions& optimiser, const AlignmentOptions& options,
                           bool afresh) {
  return iterate<P>(fc, window, state, optimiser, options, afresh ? Begin::afresh : Begin::here);
}

template <class P>
AlignmentReport align_from_all(work::Machine& fc, Window<P>& window, AlignmentState<P>& state,
                               const OptimiserOptions& optimiser, const AlignmentOptions& options) {
  using F = typename P::F32;
  const typename P::Function function("align_from_all");
  std::array<AlignmentReport, kStarts.size() + 1> reports;
  std::size_t best = 0;
  const auto cost = [&](std::size_t of) {
    return std::min(reports[of].cost_before, reports[of].cost_after);
  };
  AlignmentState<P> found = state;
  KeyframeState<P> first = window.state.keyframe(0);
  ImuBias<P> bias = window.bias;
  {
    const work::Arena::Frame frame(fc.local());
    Window<P> share = share_of<P>(fc.local(), window);
    for (std::size_t s = 0; s < reports.size(); ++s) {
      AlignmentState<P> trial{options.initial_lambda,
                              s > 0 ? F(kStarts[s - 1]) : state.inverse_depth};
      // uncounted: a few rounds, of some 100 000 cycles each
      for (int i = 0; i < options.start_iterations; ++i) {
        const Begin begin = s > 0 && i == 0 ? Begin::afresh : Begin::here;
        reports[s] = iterate<P>(fc, share, trial, optimiser, options, begin);
        if (i > 0 && reports[s].arrived) break;
      }
      if (s > 0 && !(cost(s) < cost(best))) continue;
      best = s;
      found = trial;
      first = share.state.keyframe(0);
      bias = share.bias;
    }
  }
  if (best > 0) {
    window.state.set_keyframe(0, first);
    window.bias = bias;
    state = {options.initial_lambda, found.inverse_depth};
  }
  AlignmentReport report = iterate<P>(fc, window, state, optimiser, options,
                                      best > 0 ? Begin::without_landmarks : Begin::here);
  for (std::size_t s = 0; s < reports.size(); ++s)
    report.ambiguous = report.ambiguous || (!same_scale(reports[s], reports[best], options) &&
                                            cost(s) < cost(best) + options.min_advantage);
  report.determined = report.determined && !report.ambiguous;
  return report;
}

#define LEVIOSIM_INSTANTIATE(P)                                                                \
  template AlignmentReport align_once(work::Machine&, Window<P>&, AlignmentState<P>&,          \
                                      const OptimiserOptions&, const AlignmentOptions&, bool); \
  template AlignmentReport align_from_all(work::Machine&, Window<P>&, AlignmentState<P>&,      \
                                          const OptimiserOptions&, const AlignmentOptions&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
