// What the front end does with the IMU: the motion since the last keyframe, its gravity and gyro
// bias at rest, and the pose that it predicts.
#include "workload/pipeline/front_end.h"
#include "workload/pipeline/stages.h"

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
      interval.integrate(load_imu_sample<P>(last, 0), sample, profile_.imu_noise);
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

/// Re-estimates gravity and the gyro bias if the vehicle has stood still (levio_parameters,
/// "Inertial and optimisation"). The attitude is the last keyframe's, turned as the gyro says.
/// @param seconds  that a batch of samples lasts
template <class P>
void FrontEnd<P>::detect_stillness(const Preintegration<P>& interval, float seconds) {
  const Stillness<P> seen = stillness_.evaluate();
  stillness_.end_frame();
  if (!started_ || !profile_.use_imu || !seen.still) return;
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
  graph_in_l2_.clear(ImuBias<P>::zero(), gravity_from_force<P>(force, frame.T_world_camera.R));
  graph_in_l2_.set_bias_prior(BiasPrior<P>::unknown(profile_.biases));
  Preintegration<P>(record).reset(ImuBias<P>::zero());
  graph_in_l2_.add_keyframe({frame.T_world_camera, {0.0f, 0.0f, 0.0f}}, record);
  machine_.copy_out(keyframe_.interval, record);
  store_keyframe(frame);
  started_ = true;
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
  return {from.R * delta.R, from.t + (last.velocity + fall) * delta.dt + from.R * delta.p};
}

template class FrontEnd<work::Native>;
template class FrontEnd<work::Counting>;

}  // namespace leviosim::vio
