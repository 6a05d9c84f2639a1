// What the front end does with the IMU: the motion since the last keyframe, its gravity and gyro
// bias at rest, and the pose that it predicts.
#include "workload/vio/front_end.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

/// Adds the samples since the last frame to the motion since the last keyframe. Before the first
/// frame there is no motion to measure: the forces are summed up for gravity, in the place of the
/// motion.
template <class P>
void FrontEnd<P>::integrate_imu(const FrameInput& input) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto record = local.alloc<Span<F>>("IMU interval", Preintegration<P>::kFloats);
  const auto last = local.alloc<Span<F>>("last IMU sample", kImuSampleFloats);
  const auto sums = local.alloc<Span<F>>("IMU sums of the last second", keyframe_.stillness.size());
  const Preintegration<P> interval(record);
  for (const ImuInput& in : input.imu) {
    const auto stage = machine_.stage(stages::kImu);
    const bool first = &in == input.imu.data();
    if (first) {
      machine_.copy_in(record, keyframe_.interval);
      machine_.copy_in(last, keyframe_.last_sample);
      machine_.copy_in(sums, keyframe_.stillness);
      stillness_.move_to(sums);
    }
    const ImuSample<P> sample{in.dt, R_camera_body_ * Vec3<P>{in.gyro[0], in.gyro[1], in.gyro[2]},
                              R_camera_body_ * Vec3<P>{in.accel[0], in.accel[1], in.accel[2]}};
    if (started_) {
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
    machine_.copy_out(keyframe_.interval, record);
    machine_.copy_out(keyframe_.last_sample, last);
    machine_.copy_out(keyframe_.stillness, sums);
  }
}

/// What is assumed of the step that ends with this sample.
template <class P>
ImuNoise FrontEnd<P>::noise_of(const ImuInput& sample) const {
  ImuNoise noise = profile_.imu_noise;
  const ImuDoubt& doubt = profile_.imu_doubt;
  if (!doubt.enabled) return noise;
  const auto at_end = [](const float(&axes)[3], float range) {
    F largest = work::abs(F(axes[0]));
    for (int a = 1; a < 3; ++a) largest = work::max(largest, F(work::abs(F(axes[a]))));
    return bool(largest >= F(range));
  };
  const bool gap = bool(F(sample.dt) > F(doubt.longest_step));
  if (gap || at_end(sample.gyro, doubt.gyro_range)) noise.gyro = doubt.gyro;
  if (gap || at_end(sample.accel, doubt.accel_range)) noise.accel = doubt.accel;
  return noise;
}

/// Re-estimates gravity and the gyro bias if the vehicle has stood still
/// (PARAMETERS.md#standstill). The attitude is the last keyframe's, turned as the gyro says.
/// @param seconds  that a batch of samples lasts
template <class P>
void FrontEnd<P>::detect_stillness(const Preintegration<P>& interval, float seconds) {
  const Stillness<P> seen = stillness_.evaluate();
  const Stillness<P> at_rest =
      profile_.optimiser.joint && seen.still ? stillness_.without_recent(seen) : seen;
  stillness_.end_frame();
  rest_.reset();
  recent_force_ = seen.accel_mean;
  if (!started_ || !profile_.use_imu || !seen.still) return;
  if (profile_.optimiser.joint) {
    rest_ = at_rest;
    return;  // it knows gravity, and learns the biases in motion as well
  }
  BiasPrior<P> prior = graph_in_l2_.bias_prior();
  const float gyro_variance = profile_.imu_noise.gyro * profile_.imu_noise.gyro;
  const float duration = seconds * static_cast<float>(StillnessOptions{}.batches);
  prior.mean.gyro = seen.gyro_mean;
  prior.gyro_information = work::max(prior.gyro_information, F(duration / gyro_variance));
  graph_in_l2_.set_bias_prior(prior);
  graph_in_l2_.set_bias({seen.gyro_mean, graph_in_l2_.bias().accel});
  if (!profile_.gravity_updates) return;
  const Pose<P> last = graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe()).T_world_camera;
  const Mat3<P> R_world_camera = last.R * interval.corrected(graph_in_l2_.bias()).R;
  graph_in_l2_.set_gravity(gravity_from_force<P>(seen.accel_mean, R_world_camera));
}

/// The first frame is the first keyframe; its camera frame is the world.
template <class P>
void FrontEnd<P>::start(Frame& frame) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kTriangulation);
  const auto record = local.alloc<Span<F>>("IMU interval", Preintegration<P>::kFloats);
  machine_.copy_in(record, keyframe_.interval);
  frame.T_world_camera = Pose<P>::identity();
  const Vec3<P> force = load_vec3<P>(record, 0);
  if (profile_.optimiser.joint) frame.T_world_camera.R = upright_rotation<P>(force);
  const Vec3<P> gravity = profile_.optimiser.joint
                              ? Vec3<P>{0.0f, 0.0f, -kGravity}
                              : gravity_from_force<P>(force, frame.T_world_camera.R);
  begin_world(frame, record, ImuBias<P>::zero(), gravity);
}

/// A vehicle that stands still before the first window is full starts anew with every frame, from
/// where the last one was: at rest, gravity and the gyro's bias can be read off and the velocity is
/// zero, while noise alone would sooner or later look like parallax, and the scale of a map with
/// few keyframes is a guess.
template <class P>
void FrontEnd<P>::start_at_rest(Frame& frame) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kTriangulation);
  const auto record = local.alloc<Span<F>>("IMU interval", Preintegration<P>::kFloats);
  frame.T_world_last = frame.T_world_camera = last_pose();
  Mat3<P>& R = frame.T_world_camera.R;
  R = levelled<P>(R, rest_->accel_mean);
  begin_world(frame, record, {rest_->gyro_mean, {0.0f, 0.0f, 0.0f}}, {0.0f, 0.0f, -kGravity});
  BiasPrior<P> prior = graph_in_l2_.bias_prior();
  const float stddev = profile_.optimiser.prior.rest_gyro_bias;
  prior.gyro_information = 1.0f / (stddev * stddev);
  graph_in_l2_.set_bias_prior(prior);
  velocity_known_ = true;
}

/// What became of the map cannot be true: another one begins where the camera was seen last.
template <class P>
void FrontEnd<P>::start_anew(Frame& frame) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kTriangulation);
  const auto record = local.alloc<Span<F>>("IMU interval", Preintegration<P>::kFloats);
  frame.T_world_last = frame.T_world_camera = motion_.T_world_camera();
  Mat3<P>& R = frame.T_world_camera.R;
  if (dot(recent_force_, recent_force_) > F(0.0f)) R = levelled<P>(R, recent_force_);
  begin_world(frame, record, ImuBias<P>::zero(), {0.0f, 0.0f, -kGravity});
}

/// The frame becomes the first keyframe of an empty graph.
template <class P>
void FrontEnd<P>::begin_world(const Frame& frame, Span<F> record, const ImuBias<P>& bias,
                              const Vec3<P>& gravity) {
  if (started_)
    graph_in_l2_.restart(bias, gravity);
  else
    graph_in_l2_.clear(bias, gravity);
  graph_in_l2_.set_bias_prior(BiasPrior<P>::unknown(profile_.biases));
  Preintegration<P>(record).reset(bias);
  graph_in_l2_.add_keyframe({frame.T_world_camera, {0.0f, 0.0f, 0.0f}}, record);
  machine_.copy_out(keyframe_.interval, record);
  store_keyframe(frame);
  started_ = true;
  velocity_known_ = false;
}

template <class P>
ImuDelta<P> FrontEnd<P>::motion_since_keyframe() {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto record = local.alloc<Span<F>>("IMU interval", Preintegration<P>::kFloats);
  machine_.copy_in(record, keyframe_.interval);
  return Preintegration<P>(record).corrected(graph_in_l2_.bias());
}

/// The last keyframe's pose, moved on as the IMU measured; without an IMU, at its velocity.
template <class P>
Pose<P> FrontEnd<P>::predicted_pose() {
  const KeyframeState<P> last = graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe());
  const Pose<P>& from = last.T_world_camera;
  if (!profile_.use_imu) return {from.R, from.t + last.velocity * F(time_since_keyframe_)};
  const ImuDelta<P> delta = motion_since_keyframe();
  const Vec3<P> fall = graph_in_l2_.gravity() * F(delta.dt * F(0.5f));
  const Pose<P> moved{from.R * delta.R,
                      from.t + (last.velocity + fall) * delta.dt + from.R * delta.p};
  if (!profile_.optimiser.joint) return moved;
  const Vec3<P> lever_arm{rig_.p_camera_body[0], rig_.p_camera_body[1], rig_.p_camera_body[2]};
  return {moved.R, moved.t + from.R * lever_arm - moved.R * lever_arm};
}

template class FrontEnd<work::Native>;
template class FrontEnd<work::Counting>;

}  // namespace leviosim::vio
