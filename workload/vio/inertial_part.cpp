#include "workload/vio/inertial_part.h"

#include <array>

#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

template <class P>
Mat3<P> matrix_from(const std::array<float, 9>& a) {
  return {{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}, {a[6], a[7], a[8]}}};
}

}  // namespace

template <class P>
InertialPart<P>::InertialPart(const FrontEndState<P>& state)
    : state_(state),
      R_camera_body_(matrix_from<P>(state.rig.R_camera_body)),
      stillness_(state.profile.stillness, state.keyframe.stillness) {}

template <class P>
void InertialPart<P>::integrate(const FrameInput& input) {
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  const auto last = local.alloc<Floats>("last IMU sample", kImuSampleFloats);
  const auto sums =
      local.alloc<Floats>("IMU sums of the last second", state_.keyframe.stillness.size());
  const Preintegration<P> interval(record);
  for (const ImuInput& in : input.imu) {
    const auto stage = state_.machine.stage(stages::kImu);
    const bool first = &in == input.imu.data();
    if (first) {
      state_.machine.copy_in(record, state_.keyframe.interval);
      state_.machine.copy_in(last, state_.keyframe.last_sample);
      state_.machine.copy_in(sums, state_.keyframe.stillness);
      stillness_.move_to(sums);
    }
    const ImuSample<P> sample{in.dt, R_camera_body_ * Vec3<P>{in.gyro[0], in.gyro[1], in.gyro[2]},
                              R_camera_body_ * Vec3<P>{in.accel[0], in.accel[1], in.accel[2]}};
    if (state_.started) {
      interval.integrate(load_imu_sample<P>(last, 0), sample, noise_of(in));
    } else {
      const Vec3<P> sum = first ? Vec3<P>{0.0f, 0.0f, 0.0f} : load_vec3<P>(record, 0);
      store_vec3<P>(record, 0, sum + sample.accel);
    }
    stillness_.add(sample);
    last[0] = sample.dt;
    store_vec3<P>(last, 1, sample.gyro);
    store_vec3<P>(last, 4, sample.accel);
    if (&in != &input.imu.back()) continue;
    detect_stillness(interval, input.dt);
    state_.machine.copy_out(state_.keyframe.interval, record);
    state_.machine.copy_out(state_.keyframe.last_sample, last);
    state_.machine.copy_out(state_.keyframe.stillness, sums);
  }
}

/// What is assumed of the step that ends with this sample.
template <class P>
ImuNoise InertialPart<P>::noise_of(const ImuInput& sample) const {
  ImuNoise noise = state_.profile.imu_noise;
  const ImuUncertainty& uncertainty = state_.profile.imu_uncertainty;
  if (!uncertainty.enabled) return noise;
  const auto at_end = [](const float(&axes)[3], float range) {
    F largest = work::abs(F(axes[0]));
    for (int a = 1; a < 3; ++a) largest = work::max(largest, F(work::abs(F(axes[a]))));
    return bool(largest >= F(range));
  };
  const bool gap = bool(F(sample.dt) > F(uncertainty.longest_step));
  if (gap || at_end(sample.gyro, uncertainty.gyro_range)) noise.gyro = uncertainty.gyro;
  if (gap || at_end(sample.accel, uncertainty.accel_range)) noise.accel = uncertainty.accel;
  return noise;
}

/// Whether what hardly varies can be a bias and gravity: an even turn has a larger rate, and an IMU
/// that sends nothing but zeros feels no gravity.
template <class P>
bool InertialPart<P>::may_be_rest(const Stillness<P>& seen) const {
  const RestOptions& limits = state_.profile.rest;
  const float least = kGravity - limits.accel_error, most = kGravity + limits.accel_error;
  const F rate = dot(seen.gyro_mean, seen.gyro_mean);
  const F force = dot(seen.accel_mean, seen.accel_mean);
  return bool(rate < F(limits.gyro_bias * limits.gyro_bias)) && bool(force > F(least * least)) &&
         bool(force < F(most * most));
}

/// Re-estimates gravity and the gyro bias if the vehicle has stood still
/// (PARAMETERS.md#standstill). The attitude is the last keyframe's, turned as the gyro says.
/// @param seconds  that a batch of samples lasts
template <class P>
void InertialPart<P>::detect_stillness(const Preintegration<P>& interval, float seconds) {
  const Stillness<P> seen = stillness_.evaluate();
  const Stillness<P> at_rest =
      state_.profile.optimiser.joint && seen.still ? stillness_.without_recent(seen) : seen;
  stillness_.end_frame();
  rest_.reset();
  recent_ = seen;
  if (!seen.still) rest_is_rejected_ = false;
  if (!state_.started || !state_.profile.use_imu || !seen.still) return;
  if (state_.profile.optimiser.joint) {
    if (!rest_is_rejected_ && may_be_rest(at_rest)) rest_ = at_rest;
    return;  // it knows gravity, and learns the biases in motion as well
  }
  BiasPrior<P> prior = state_.graph_in_l2.bias_prior();
  const float gyro_variance = state_.profile.imu_noise.gyro * state_.profile.imu_noise.gyro;
  const float duration = seconds * static_cast<float>(state_.profile.stillness.batches);
  prior.mean.gyro = seen.gyro_mean;
  prior.gyro_information = work::max(prior.gyro_information, F(duration / gyro_variance));
  state_.graph_in_l2.set_bias_prior(prior);
  state_.graph_in_l2.set_bias({seen.gyro_mean, state_.graph_in_l2.bias().accel});
  if (!state_.profile.gravity_updates) return;
  const Pose<P> last = state_.newest_keyframe().T_world_camera;
  const Mat3<P> R_world_camera = last.R * interval.corrected(state_.graph_in_l2.bias()).R;
  state_.graph_in_l2.set_gravity(gravity_from_force<P>(seen.accel_mean, R_world_camera));
}

template <class P>
ImuDelta<P> InertialPart<P>::motion_since_keyframe() const {
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  state_.machine.copy_in(record, state_.keyframe.interval);
  return Preintegration<P>(record).corrected(state_.graph_in_l2.bias());
}

template <class P>
Vec3<P> InertialPart<P>::lever_arm() const {
  const auto& p = state_.rig.p_camera_body;
  return {p[0], p[1], p[2]};
}

template <class P>
Pose<P> InertialPart<P>::moved_on(const KeyframeState<P>& keyframe,
                                  const ImuDelta<P>& delta) const {
  const Pose<P>& from = keyframe.T_world_camera;
  const Vec3<P> fall = state_.graph_in_l2.gravity() * F(delta.dt * F(0.5f));
  const Pose<P> moved{from.R * delta.R,
                      from.t + (keyframe.velocity + fall) * delta.dt + from.R * delta.p};
  if (!state_.profile.optimiser.joint) return moved;
  return {moved.R, moved.t + from.R * lever_arm() - moved.R * lever_arm()};
}

template <class P>
KeyframeState<P> InertialPart<P>::moved_back(const KeyframeState<P>& to,
                                             const ImuDelta<P>& delta) const {
  const Mat3<P> R = orthonormalised<P>(to.T_world_camera.R * transpose(delta.R));
  const Vec3<P> fallen = state_.graph_in_l2.gravity() * delta.dt;
  const Vec3<P> velocity = to.velocity - fallen - R * delta.v;
  const KeyframeState<P> still{{R, {0.0f, 0.0f, 0.0f}}, velocity};
  return {{R, to.T_world_camera.t - moved_on(still, delta).t}, velocity};
}

template <class P>
Pose<P> InertialPart<P>::predicted_pose() const {
  const KeyframeState<P> last = state_.newest_keyframe();
  if (!state_.profile.use_imu)
    return {last.T_world_camera.R,
            last.T_world_camera.t + last.velocity * F(state_.time_since_keyframe)};
  return moved_on(last, motion_since_keyframe());
}

template class InertialPart<work::Native>;
template class InertialPart<work::Counting>;

}  // namespace leviosim::vio
