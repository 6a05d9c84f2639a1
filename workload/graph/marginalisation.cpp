#include "workload/graph/marginalisation.h"

#include "workload/graph/departing_visual_terms.h"
#include "workload/graph/interval_rows.h"
#include "workload/graph/reduced_system.h"
#include "workload/math/rotations.h"

namespace leviosim::vio {
namespace {

constexpr int kPerKeyframe = 9;

/// Where unknown i of the prior lies in a system of more keyframes.
template <class P>
int place(const WindowPrior<P>& prior, const ReducedSystem<P>& system, int i) {
  const int of_keyframes = kPerKeyframe * prior.keyframes;
  return i < of_keyframes ? i : system.shared() + i - of_keyframes;
}

/// x ⊟ x₀, into prior.difference.
template <class P>
void take_difference(const WindowPrior<P>& prior, const WindowState<P>& state,
                     const ImuBias<P>& bias) {
  const auto to = prior.difference;
  for (int k : P::range(0, prior.keyframes)) {
    const KeyframeState<P> now = state.keyframe(k), before = prior.state.keyframe(k);
    const Mat3<P> turn = transpose(before.T_world_camera.R) * now.T_world_camera.R;
    store_vec3<P>(to, kPerKeyframe * k, so3_log<P>(turn));
    store_vec3<P>(to, kPerKeyframe * k + kPositionColumn,
                  now.T_world_camera.t - before.T_world_camera.t);
    store_vec3<P>(to, kPerKeyframe * k + kVelocityColumn, now.velocity - before.velocity);
  }
  const int biases = kPerKeyframe * prior.keyframes;
  store_vec3<P>(to, biases, bias.gyro - prior.bias.gyro);
  store_vec3<P>(to, biases + 3, bias.accel - prior.bias.accel);
}

/// Row i of b − H (x ⊟ x₀).
template <class P>
typename P::F32 gradient(const WindowPrior<P>& prior, int i) {
  using F = typename P::F32;
  const int n = prior.unknowns();
  F sum = prior.vector[i];
  for (int j : P::range(0, n)) sum -= prior.information[i * n + j] * prior.difference[j];
  return sum;
}

/// How far the oldest keyframe is from where it is held.
template <class P>
struct GaugeError {
  using F = typename P::F32;

  GaugeError(const WindowPrior<P>& prior, const WindowState<P>& state) {
    const Pose<P> now = state.pose(0), before = prior.state.pose(0);
    up = {before.R.m[2][0], before.R.m[2][1], before.R.m[2][2]};
    heading = dot(up, so3_log<P>(transpose(before.R) * now.R));
    position = now.t - before.t;
  }
  F cost(const PriorOptions& options) const {
    return F(0.5f) * (F(information(options.heading)) * heading * heading +
                      F(information(options.position)) * dot(position, position));
  }

  Vec3<P> up;  ///< in the camera frame
  F heading;   ///< rad
  Vec3<P> position;
};

/// The biases have walked for `seconds` since the prior was taken.
template <class P>
void add_walk(const WindowPrior<P>& prior, typename P::F32 seconds, const PriorOptions& options) {
  using F = typename P::F32;
  const typename P::Function function("add_walk");
  const int n = prior.unknowns();
  const auto h = prior.difference;
  for (int b : P::range(0, kBiasUnknowns)) {
    const int i = n - kBiasUnknowns + b;
    const float walk = b < 3 ? options.gyro_walk : options.accel_walk;
    const F q = F(walk * walk) * seconds;
    for (int r : P::range(0, n)) h[r] = F(prior.information[i * n + r]);
    const F scale = q / (F(1.0f) + q * F(h[i]));
    const F b_i = F(prior.vector[i]) * scale;
    for (int r : P::range(0, n)) {
      const F scaled_h = F(h[r]) * scale;
      for (int c : P::range(0, n)) prior.information[r * n + c] -= scaled_h * h[c];
      prior.vector[r] -= h[r] * b_i;
    }
  }
}

/// The system without its first unknowns becomes the prior, linearised at the window's state.
template <class P>
void adopt(const Window<P>& window, int departed, const ReducedSystem<P>& system,
           WindowPrior<P>& prior) {
  using F = typename P::F32;
  prior.keyframes = window.keyframes - departed;
  const int n = prior.unknowns(), skipped = kPerKeyframe * departed;
  const MatrixView<P> matrix = system.matrix();
  for (int r : P::range(0, n)) {
    for (int c : P::range(0, r + 1)) {
      const F element = matrix(skipped + r, skipped + c);
      prior.information[r * n + c] = element;
      prior.information[c * n + r] = element;
    }
    prior.vector[r] = F(system.vector()[skipped + r]);
  }
  for (int k : P::range(0, prior.keyframes))
    prior.state.set_keyframe(k, window.state.keyframe(k + departed));
  prior.bias = window.bias;
}

/// Besides the records.
template <class P>
struct MarginalisationMemory {
  MarginalisationMemory(work::Arena& arena, const Window<P>& window)
      : system(arena, window.keyframes, true, kBiasUnknowns),
        projection(arena, window.capacity.keyframes),
        interval(arena) {}

  ReducedSystem<P> system;
  ProjectionScratch<P> projection;
  JointScratch<P> interval;
};

}  // namespace

template <class P>
WindowPrior<P>::WindowPrior(work::Arena& arena, int most)
    : information(arena.alloc<Span>("prior information", unknowns_of(most) * unknowns_of(most))),
      vector(arena.alloc<Span>("prior vector", unknowns_of(most))),
      difference(arena.alloc<Span>("prior difference", unknowns_of(most))),
      state{arena.alloc<Span>("prior poses", kPoseFloats * most),
            arena.alloc<Span>("prior velocities", 3 * most),
            {}} {}

template <class P>
void start_prior(const Window<P>& window, const PriorOptions& options, WindowPrior<P>& prior) {
  using F = typename P::F32;
  const typename P::Function function("start_prior");
  const F known = window.bias_prior.gyro_information;
  const bool rest = bool(known > F(4 * information(options.gyro_bias)));
  const F tilt = information(rest ? options.rest_tilt : options.tilt);
  const F velocity = information(rest ? options.rest_velocity : options.velocity);
  const F gyro_bias = information(rest ? options.rest_gyro_bias : options.gyro_bias);
  prior.keyframes = 1;
  const int n = prior.unknowns();
  for (int i : P::range(0, n * n)) prior.information[i] = 0.0f;
  for (int i : P::range(0, n)) prior.vector[i] = 0.0f;
  for (int i = 0; i < 3; ++i) {
    prior.information[i * n + i] = tilt;
    prior.information[(kVelocityColumn + i) * (n + 1)] = velocity;
    prior.information[(kPerKeyframe + i) * (n + 1)] = gyro_bias;
    prior.information[(kPerKeyframe + 3 + i) * (n + 1)] = F(information(options.accel_bias));
  }
  prior.state.set_keyframe(0, window.state.keyframe(0));
  prior.bias = window.bias;
}

template <class P>
void eliminate_first(const ReducedSystem<P>& system, int n) {
  using F = typename P::F32;
  const typename P::Function function("eliminate_first");
  const MatrixView<P> H = system.matrix();
  const auto b = system.vector();
  for (int i : P::range(0, n)) {
    const F pivot = H(i, i);
    if (!(pivot > 0.0f)) continue;
    const F inverse = F(1.0f) / pivot;
    const F b_i = b[i];
    for (int r : P::range(i + 1, system.unknowns())) {
      const F factor = H(r, i) * inverse;
      for (int c : P::range(i + 1, r + 1)) H(r, c) -= factor * H(c, i);
      b[r] -= factor * b_i;
    }
  }
}

template <class P>
void marginalise(work::Machine& machine, const Window<P>& window, int departed,
                 const ReprojectionOptions& visual, const PriorOptions& options,
                 WindowPrior<P>& prior) {
  using F = typename P::F32;
  const typename P::Function function("marginalise");
  const work::Arena::Frame frame(machine.local()), behind(machine.behind());
  const auto others = [&] { return MarginalisationMemory<P>(machine.local(), window); };
  const LandmarkRecords<P> records(machine, window.capacity.landmarks, window.capacity.keyframes,
                                   room_beside(machine.local(), others));
  const auto [system, projection, interval] = others();
  system.clear();
  add_departing_visual_terms<P>(machine, window, PixelModel<P>(visual), departed,
                                options.tracked_landmarks, records, projection, system);
  add_joint_inertial_terms<P>(window, 1, departed, interval, system);
  add_prior<P>(prior, window, system);
  for (int i : P::range(0, system.unknowns())) {
    const F diagonal = system.matrix()(i, i);
    system.matrix()(i, i) = diagonal + diagonal * F(options.floor);
  }
  eliminate_first<P>(system, kPerKeyframe * departed);
  F seconds = 0.0f;
  for (int k : P::range(1, departed + 1)) seconds += window.interval(k).duration();
  adopt<P>(window, departed, system, prior);
  add_walk<P>(prior, seconds, options);
}

template <class P>
typename P::F32 add_prior(const WindowPrior<P>& prior, const Window<P>& window,
                          const ReducedSystem<P>& system) {
  using F = typename P::F32;
  const typename P::Function function("add_prior");
  take_difference<P>(prior, window.state, window.bias);
  const int n = prior.unknowns();
  const MatrixView<P> matrix = system.matrix();
  F cost = 0.0f;
  for (int i : P::range(0, n)) {
    const F g = gradient<P>(prior, i);
    cost -= F(prior.difference[i]) * (F(prior.vector[i]) + g);
    system.vector()[place<P>(prior, system, i)] += g;
    for (int j : P::range(0, i + 1))
      matrix(place<P>(prior, system, i), place<P>(prior, system, j)) +=
          F(prior.information[i * n + j]);
  }
  return cost * F(0.5f);
}

template <class P>
typename P::F32 prior_cost(const WindowPrior<P>& prior, const WindowState<P>& state,
                           const ImuBias<P>& bias) {
  using F = typename P::F32;
  const typename P::Function function("prior_cost");
  take_difference<P>(prior, state, bias);
  F cost = 0.0f;
  for (int i : P::range(0, prior.unknowns()))
    cost -= F(prior.difference[i]) * (F(prior.vector[i]) + gradient<P>(prior, i));
  return cost * F(0.5f);
}

template <class P>
typename P::F32 hold_gauge(const WindowPrior<P>& prior, const WindowState<P>& state,
                           const PriorOptions& options, const ReducedSystem<P>& system) {
  using F = typename P::F32;
  const typename P::Function function("hold_gauge");
  const GaugeError<P> error(prior, state);
  const F heading = information(options.heading), position = information(options.position);
  const F up[3] = {error.up.x, error.up.y, error.up.z};
  const F off[3] = {error.position.x, error.position.y, error.position.z};
  const MatrixView<P> matrix = system.matrix();
  const auto b = system.vector();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c <= r; ++c) matrix(r, c) += heading * up[r] * up[c];
    b[r] -= heading * up[r] * error.heading;
    matrix(kPositionColumn + r, kPositionColumn + r) += position;
    b[kPositionColumn + r] -= position * off[r];
  }
  return error.cost(options);
}

template <class P>
typename P::F32 gauge_cost(const WindowPrior<P>& prior, const WindowState<P>& state,
                           const PriorOptions& options) {
  return GaugeError<P>(prior, state).cost(options);
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template P::F32 hold_gauge(const WindowPrior<P>&, const WindowState<P>&, const PriorOptions&,  \
                             const ReducedSystem<P>&);                                           \
  template P::F32 gauge_cost(const WindowPrior<P>&, const WindowState<P>&, const PriorOptions&); \
  template struct WindowPrior<P>;                                                                \
  template void start_prior(const Window<P>&, const PriorOptions&, WindowPrior<P>&);             \
  template void marginalise(work::Machine&, const Window<P>&, int, const ReprojectionOptions&,   \
                            const PriorOptions&, WindowPrior<P>&);                               \
  template P::F32 add_prior(const WindowPrior<P>&, const Window<P>&, const ReducedSystem<P>&);   \
  template P::F32 prior_cost(const WindowPrior<P>&, const WindowState<P>&, const ImuBias<P>&);   \
  template void eliminate_first(const ReducedSystem<P>&, int);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
