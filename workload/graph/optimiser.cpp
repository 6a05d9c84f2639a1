#include "workload/graph/optimiser.h"

#include "workload/graph/visual_terms.h"

namespace leviosim::vio {
namespace {

/// From more damping on the scale looks too certain: that of landmarks is not undone. Of 1e-6 it
/// hides a fifth of the deviation.
constexpr float kHardlyDamped = 2e-6f;

/// The variance of a linear function of the unknowns without the damping: along the direction in
/// which they vary most the information that damping adds is subtracted.
/// @param factor        of the damped system
/// @param coefficients  overwritten
template <class P>
typename P::F32 undamped_variance(ConstMatrixView<P> factor, typename P::F32 lambda,
                                  typename P::template Span<typename P::F32> coefficients) {
  using F = typename P::F32;
  const F variance = square_by_inverse<P>(factor, coefficients);
  back_substitute<P>(factor, coefficients);
  F added = 0.0f;
  for (int i : P::range(0, factor.rows())) {
    const F pivot = F(1.0f) / F(factor(i, i));
    F diagonal = pivot * pivot;
    for (int k : P::range(0, i)) diagonal += F(factor(i, k)) * F(factor(i, k));
    added += diagonal * F(coefficients[i]) * F(coefficients[i]);
  }
  added = added * lambda / (F(1.0f) + lambda);
  return variance * variance / work::max(F(variance - added), F(variance * F(0.01f)));
}

/// The variance of the scale of the keyframes' positions, as a share of it: that of the mean of
/// their displacements along their distances from their centre, weighted with these.
/// @param solved  its vector, the step, is overwritten
template <class P>
typename P::F32 scale_variance(const Window<P>& window, typename P::F32 lambda,
                               const ReducedSystem<P>& solved) {
  using F = typename P::F32;
  Vec3<P> centre{0.0f, 0.0f, 0.0f};
  for (int k : P::range(0, window.keyframes)) centre = centre + window.state.pose(k).t;
  centre = centre * F(1.0f / static_cast<float>(window.keyframes));
  const auto weights = solved.vector();
  for (int i : P::range(0, solved.unknowns())) weights[i] = 0.0f;
  F square = 0.0f;
  for (int k : P::range(0, window.keyframes)) {
    const Vec3<P> off = window.state.pose(k).t - centre;
    store_vec3<P>(weights, k * solved.per_keyframe() + 3, off);
    square += dot(off, off);
  }
  return undamped_variance<P>(solved.matrix(), lambda, weights) /
         work::max(F(square * square), F(1e-12f));
}

// How an iteration takes IMU and past into account: one of the two structs below.

/// Biases apart, anchor.
template <class P>
struct AnchoredTerms {
  using F = typename P::F32;

  AnchoredTerms(work::Arena& arena, const Window<P>& in, const OptimiserOptions& o)
      : window(in), options(o), interval(arena) {}
  static ReducedSystem<P> system(work::Arena& arena, const Window<P>& window,
                                 const OptimiserOptions& options) {
    return {arena, window.keyframes, options.use_imu};
  }

  F add(const ReducedSystem<P>& system, F cost, IterationReport& report) const {
    if (options.use_imu) {
      const F inertial = add_inertial_terms<P>(window, interval, system);
      report.inertial = work::value(inertial);
      cost += inertial;
    }
    const F anchor = add_anchor<P>(window, options.anchor, system);
    report.prior = work::value(anchor);
    cost += anchor;
    return cost;
  }
  void step(const ReducedSystem<P>&) {}
  void measure_scale(const ReducedSystem<P>&, F, IterationReport&) const {}
  F add_cost(const WindowState<P>& state, F cost) const {
    if (options.use_imu) cost += inertial_cost<P>(window, state, interval);
    cost += anchor_cost<P>(window, state, options.anchor, options.use_imu);
    return cost;
  }
  void adopt(Window<P>&) const {}

  const Window<P>& window;
  const OptimiserOptions& options;
  IntervalScratch<P> interval;
};

/// Biases in common, prior.
template <class P>
struct JointTerms {
  using F = typename P::F32;

  JointTerms(work::Arena& arena, const Window<P>& in, const OptimiserOptions& o)
      : window(in), options(o), interval(arena), trial_bias(in.bias) {}
  static ReducedSystem<P> system(work::Arena& arena, const Window<P>& window,
                                 const OptimiserOptions&) {
    return {arena, window.keyframes, true, kBiasUnknowns};
  }

  F add(const ReducedSystem<P>& system, F cost, IterationReport& report) const {
    const F inertial =
        add_joint_inertial_terms<P>(window, 1, window.keyframes - 1, interval, system);
    const F past = add_prior<P>(*prior, window, system);
    report.inertial = work::value(inertial);
    report.prior = work::value(past);
    cost += inertial;
    cost += past;
    cost += hold_gauge<P>(*prior, window.state, options.prior, system);
    return cost;
  }
  void step(const ReducedSystem<P>& solved) {
    const auto step = solved.vector();
    trial_bias = {window.bias.gyro + load_vec3<P>(step, solved.shared()),
                  window.bias.accel + load_vec3<P>(step, solved.shared() + 3)};
  }
  void measure_scale(const ReducedSystem<P>& solved, F lambda, IterationReport& report) const {
    const bool full = window.keyframes == window.capacity.keyframes;
    if (!full || !(lambda <= kHardlyDamped)) return;
    report.scale_sigma = work::value(work::sqrt(scale_variance<P>(window, lambda, solved)));
  }
  F add_cost(const WindowState<P>& state, F cost) const {
    cost += joint_inertial_cost<P>(window, state, trial_bias, interval);
    cost += prior_cost<P>(*prior, state, trial_bias);
    cost += gauge_cost<P>(*prior, state, options.prior);
    return cost;
  }
  void adopt(Window<P>& to) const {
    to.bias = trial_bias;
    to.bias_is_new = true;
  }

  const Window<P>& window;
  const OptimiserOptions& options;
  const WindowPrior<P>* prior = nullptr;
  JointScratch<P> interval;
  ImuBias<P> trial_bias;
};

/// The work memory of an iteration besides the records, sized for the largest window as the
/// release's is.
template <class P, class Terms>
struct WorkMemory {
  using Span = typename P::template Span<typename P::F32>;

  WorkMemory(work::Arena& arena, const Window<P>& window, const OptimiserOptions& options)
      : system(Terms::system(arena, window, options)),
        elimination(arena, window.capacity.keyframes),
        terms(arena, window, options),
        trial{arena.alloc<Span>("trial poses", kPoseFloats * window.keyframes),
              arena.alloc<Span>("trial velocities", 3 * window.keyframes),
              arena.alloc<Span>("trial points", 3 * window.capacity.landmarks)} {}

  ReducedSystem<P> system;
  EliminationScratch<P> elimination;
  Terms terms;
  WindowState<P> trial;
};

template <class P>
void step_keyframes(const Window<P>& window, const ReducedSystem<P>& solved,
                    const WindowState<P>& to) {
  const typename P::Function function("step_keyframes");
  for (int k : P::range(0, window.keyframes))
    to.set_keyframe(k, solved.moved(window.state.keyframe(k), k));
}

/// Linearises everything at the window's state.
/// @param report  what took part, and the parts of the cost
/// @return the cost there
template <class P, class Terms>
typename P::F32 build(work::Machine& fc, const Window<P>& window, const OptimiserOptions& options,
                      typename P::F32 lambda, const LandmarkRecords<P>& records,
                      const WorkMemory<P, Terms>& memory, IterationReport& report) {
  using F = typename P::F32;
  memory.system.clear();
  F cost = 0.0f;
  const VisualUse use = add_visual_terms<P>(fc, window, PixelModel<P>(options.visual), lambda,
                                            records, memory.elimination, memory.system, cost);
  report.landmarks = use.landmarks;
  report.observations = use.observations;
  report.visual = work::value(cost);
  cost = memory.terms.add(memory.system, cost, report);
  memory.system.damp(lambda);
  return cost;
}

/// Cost of the trial state, whose points are settled first.
template <class P, class Terms>
typename P::F32 cost_of_trial(const Window<P>& window, const WindowState<P>& state,
                              const OptimiserOptions& options, const Terms& terms) {
  const typename P::F32 cost = settle_points<P>(window, state, PixelModel<P>(options.visual));
  return terms.add_cost(state, cost);
}

/// @param prepare  completes the terms
template <class P, class Terms, class Prepare>
IterationReport iterate(work::Machine& fc, Window<P>& window, LmState<P>& lm,
                        const OptimiserOptions& options, const Prepare& prepare) {
  using F = typename P::F32;
  const typename P::Function function("optimise_once");
  IterationReport report;
  report.lambda = work::value(lm.lambda);
  if (window.keyframes < 2) return report;

  const work::Arena::Frame frame(fc.local()), behind(fc.behind());
  const auto others = [&] { return WorkMemory<P, Terms>(fc.local(), window, options); };
  const LandmarkRecords<P> records(fc, window.capacity.landmarks, window.capacity.keyframes,
                                   room_beside(fc.local(), others));
  WorkMemory<P, Terms> memory = others();
  prepare(memory.terms);
  const F cost = build<P>(fc, window, options, lm.lambda, records, memory, report);
  F trial_cost = cost;
  report.positive_definite = memory.system.solve();
  if (report.positive_definite) {
    step_keyframes<P>(window, memory.system, memory.trial);
    memory.terms.step(memory.system);
    step_points<P>(fc, window, records, memory.system, memory.trial.points);
    memory.terms.measure_scale(memory.system, lm.lambda, report);
    trial_cost = cost_of_trial<P>(window, memory.trial, options, memory.terms);
  }
  // Not true either if a cost is not a number.
  if (trial_cost < cost) {
    window.adopt(memory.trial);
    memory.terms.adopt(window);
    lm.lambda = work::max(F(lm.lambda * options.lambda_down), F(options.min_lambda));
    report.accepted = true;
  } else {
    lm.lambda = work::min(F(lm.lambda * options.lambda_up), F(options.max_lambda));
  }
  report.cost_before = work::value(cost);
  report.cost_after = work::value(trial_cost);
  return report;
}

}  // namespace

template <class P>
IterationReport optimise_once(work::Machine& fc, Window<P>& window, LmState<P>& lm,
                              const OptimiserOptions& options) {
  return iterate<P, AnchoredTerms<P>>(fc, window, lm, options, [](AnchoredTerms<P>&) {});
}

template <class P>
IterationReport optimise_jointly_once(work::Machine& fc, Window<P>& window,
                                      const WindowPrior<P>& prior, LmState<P>& lm,
                                      const OptimiserOptions& options) {
  return iterate<P, JointTerms<P>>(fc, window, lm, options,
                                   [&](JointTerms<P>& terms) { terms.prior = &prior; });
}

template IterationReport optimise_jointly_once(work::Machine&, Window<work::Native>&,
                                               const WindowPrior<work::Native>&,
                                               LmState<work::Native>&, const OptimiserOptions&);
template IterationReport optimise_jointly_once(work::Machine&, Window<work::Counting>&,
                                               const WindowPrior<work::Counting>&,
                                               LmState<work::Counting>&, const OptimiserOptions&);
template IterationReport optimise_once(work::Machine&, Window<work::Native>&,
                                       LmState<work::Native>&, const OptimiserOptions&);
template IterationReport optimise_once(work::Machine&, Window<work::Counting>&,
                                       LmState<work::Counting>&, const OptimiserOptions&);

}  // namespace leviosim::vio
