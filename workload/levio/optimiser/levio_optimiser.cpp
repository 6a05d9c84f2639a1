#include "workload/levio/optimiser/levio_optimiser.h"

#include "workload/graph/reduced_system.h"
#include "workload/graph/window.h"
#include "workload/levio/optimiser/cholesky.h"
#include "workload/levio/optimiser/levio_visual_terms.h"

namespace leviosim::vio::levio {
namespace {

// The kinematic prior of the released program (PARAMETERS.md#optimiser): the velocity of a keyframe
// is that of the way from the one before, v_j = (p_j − p_i) / Δt.

namespace kinematic {

inline constexpr int kPosition = 3, kVelocity = 6;  ///< places in a keyframe's unknowns

template <class P>
Vec3<P> residual(const WindowState<P>& state, int k, typename P::F32 rate) {
  const KeyframeState<P> end = state.keyframe(k);
  return end.velocity - (end.T_world_camera.t - state.pose(k - 1).t) * rate;
}

/// Reciprocal of the time between keyframes k - 1 and k; 0 if there is no interval.
template <class P>
typename P::F32 rate_of(const Window<P>& window, int k) {
  using F = typename P::F32;
  const F duration = window.interval(k).duration();
  if (!(duration > 0.0f)) return 0.0f;
  return F(1.0f) / duration;
}

}  // namespace kinematic

/// Adds the prior of all intervals.
template <class P>
void add_kinematic_prior(const Window<P>& window, typename P::F32 weight,
                         const ReducedSystem<P>& system) {
  using F = typename P::F32;
  const typename P::Function function("levio_add_kinematic_prior");
  const MatrixView<P> matrix = system.matrix();
  const auto b = system.vector();
  for (int k : P::range(1, window.keyframes)) {
    const F rate = kinematic::rate_of<P>(window, k);
    if (!(rate > 0.0f)) continue;
    const Vec3<P> r = kinematic::residual<P>(window.state, k, rate);
    const F residual[3] = {r.x, r.y, r.z};
    const int before = (k - 1) * system.per_keyframe() + kinematic::kPosition;
    const int position = k * system.per_keyframe() + kinematic::kPosition;
    const int velocity = k * system.per_keyframe() + kinematic::kVelocity;
    const F by_way = weight * rate;
    const F by_both = by_way * rate;
    for (int c = 0; c < 3; ++c) {
      // Derivatives: rate by the position before, −rate by the position, 1 by the velocity.
      matrix(before + c, before + c) += by_both;
      matrix(position + c, position + c) += by_both;
      matrix(velocity + c, velocity + c) += weight;
      matrix(position + c, before + c) -= by_both;
      matrix(velocity + c, before + c) += by_way;
      matrix(velocity + c, position + c) -= by_way;
      b[before + c] -= by_way * residual[c];
      b[position + c] += by_way * residual[c];
      b[velocity + c] -= weight * residual[c];
    }
  }
}

template <class P>
typename P::F32 kinematic_cost(const Window<P>& window, const WindowState<P>& state,
                               typename P::F32 weight) {
  using F = typename P::F32;
  const typename P::Function function("levio_kinematic_cost");
  F sum = 0.0f;
  for (int k : P::range(1, window.keyframes)) {
    const F rate = kinematic::rate_of<P>(window, k);
    if (!(rate > 0.0f)) continue;
    const Vec3<P> r = kinematic::residual<P>(state, k, rate);
    sum += F(dot(r, r));
  }
  return 0.5f * weight * sum;
}

/// The work memory of an iteration besides the records, sized for the largest window.
template <class P>
struct WorkMemory {
  using Span = typename P::template Span<typename P::F32>;
  using Bytes = typename P::template Span<typename P::Byte>;

  WorkMemory(work::Arena& arena, const Window<P>& window, const OptimiserOptions& options)
      : cleared(arena.alloc<Bytes>("cleared record",
                                   4 * LandmarkRecords<P>::floats_of(window.capacity.keyframes))),
        system(arena, window.keyframes, options.use_imu),
        interval(arena),
        trial{arena.alloc<Span>("trial poses", kPoseFloats * window.keyframes),
              arena.alloc<Span>("trial velocities", 3 * window.keyframes),
              arena.alloc<Span>("trial points", 3 * window.capacity.landmarks)} {}

  Bytes cleared;
  ReducedSystem<P> system;
  IntervalScratch<P> interval;
  WindowState<P> trial;
};

/// The cost of everything but the landmarks at `state`.
template <class P>
typename P::F32 add_other_costs(const Window<P>& window, const WindowState<P>& state,
                                const OptimiserOptions& options, const WorkMemory<P>& memory,
                                typename P::F32 cost) {
  using F = typename P::F32;
  if (options.use_imu) {
    cost += inertial_cost<P>(window, state, memory.interval);
    cost += kinematic_cost<P>(window, state, F(kKinematicWeight));
  }
  cost += anchor_cost<P>(window, state, options.anchor, options.use_imu);
  return cost;
}

/// λ is added to the diagonals of the poses. An unknown that no residual touches stays where it is.
template <class P>
void damp(const ReducedSystem<P>& system, typename P::F32 lambda) {
  using F = typename P::F32;
  const MatrixView<P> matrix = system.matrix();
  // uncounted: a round for each keyframe of the window
  for (int at = 0; at < system.unknowns(); at += system.per_keyframe())
    for (int i : P::range(0, system.per_keyframe())) {
      F diagonal = matrix(at + i, at + i);
      if (i < ReducedSystem<P>::kPoseUnknowns) diagonal += lambda;
      if (!(diagonal > 0.0f)) diagonal = 1.0f;
      matrix(at + i, at + i) = diagonal;
    }
}

/// Linearises everything at the window's state.
/// @return the cost there
template <class P>
typename P::F32 build(work::Machine& machine, const Window<P>& window,
                      const OptimiserOptions& options, typename P::F32 lambda,
                      const LandmarkRecords<P>& records, const WorkMemory<P>& memory,
                      VisualUse& use) {
  using F = typename P::F32;
  memory.system.clear();
  F cost = 0.0f;
  use = levio::add_visual_terms<P>(machine, window, PixelModel<P>(options.visual), lambda, records,
                                   memory.cleared, memory.system, cost);
  if (options.use_imu) {
    cost += add_inertial_terms<P>(window, memory.interval, memory.system);
    add_kinematic_prior<P>(window, F(kKinematicWeight), memory.system);
    cost += kinematic_cost<P>(window, window.state, F(kKinematicWeight));
  }
  cost += add_anchor<P>(window, options.anchor, memory.system);
  damp<P>(memory.system, lambda);
  return cost;
}

/// The step in place of the right-hand side; none if the matrix is not positive definite.
template <class P>
bool solve(const ReducedSystem<P>& system) {
  if (levio::cholesky_factor<P>(system.matrix())) {
    levio::cholesky_solve<P>(system.matrix(), system.vector());
    return true;
  }
  for (int i : P::range(0, system.unknowns())) system.vector()[i] = 0.0f;
  return false;
}

template <class P>
void step_keyframes(const Window<P>& window, const ReducedSystem<P>& solved,
                    const WindowState<P>& to) {
  const typename P::Function function("levio_step_keyframes");
  for (int k : P::range(0, window.keyframes))
    to.set_keyframe(k, solved.moved(window.state.keyframe(k), k));
}

}  // namespace

template <class P>
IterationReport optimise_once(work::Machine& machine, Window<P>& window, LmState<P>& lm,
                              const OptimiserOptions& options) {
  using F = typename P::F32;
  const typename P::Function function("levio_optimise_once");
  IterationReport report;
  report.lambda = work::value(lm.lambda);
  if (window.keyframes < 2) return report;

  const work::Arena::Frame frame(machine.local()), behind(machine.behind());
  const auto others = [&] { return WorkMemory<P>(machine.local(), window, options); };
  const LandmarkRecords<P> records(machine, window.capacity.landmarks, window.capacity.keyframes,
                                   room_beside(machine.local(), others));
  const WorkMemory<P> memory = others();
  VisualUse use;
  const F cost = build<P>(machine, window, options, lm.lambda, records, memory, use);
  report.positive_definite = solve<P>(memory.system);
  step_keyframes<P>(window, memory.system, memory.trial);
  step_points<P>(machine, window, records, memory.system, memory.trial.points);
  const F visual_cost =
      levio::settle_points<P>(window, memory.trial, PixelModel<P>(options.visual));
  const F trial_cost = add_other_costs<P>(window, memory.trial, options, memory, visual_cost);
  // Not true either if a cost is not a number.
  if (report.positive_definite && trial_cost < cost) {
    window.adopt(memory.trial);
    lm.lambda = work::max(F(lm.lambda * options.lambda_down), F(options.min_lambda));
    report.accepted = true;
  } else {
    lm.lambda = work::min(F(lm.lambda * options.lambda_up), F(options.max_lambda));
  }
  report.cost_before = work::value(cost);
  report.cost_after = work::value(trial_cost);
  report.landmarks = use.landmarks;
  report.observations = use.observations;
  return report;
}

template IterationReport optimise_once(work::Machine&, Window<work::Native>&,
                                       LmState<work::Native>&, const OptimiserOptions&);
template IterationReport optimise_once(work::Machine&, Window<work::Counting>&,
                                       LmState<work::Counting>&, const OptimiserOptions&);

}  // namespace leviosim::vio::levio
