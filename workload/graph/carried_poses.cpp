#include "workload/graph/carried_poses.h"

#include "workload/inertial/record_sums.h"

namespace leviosim::vio {
namespace {

/// Motion from the first keyframe on, free of velocity and gravity, as the intervals add up to it.
template <class P>
struct Sum {
  using F = typename P::F32;

  Mat3<P> R = Mat3<P>::identity();
  Vec3<P> v{0.0f, 0.0f, 0.0f}, p{0.0f, 0.0f, 0.0f};
  F time = 0.0f;
  Mat3<P> R_by_gyro = Mat3<P>::zero();
  Mat3<P> v_by_gyro = Mat3<P>::zero(), v_by_accel = Mat3<P>::zero();
  Mat3<P> p_by_gyro = Mat3<P>::zero(), p_by_accel = Mat3<P>::zero();

  void add(const Preintegration<P>& interval, const ImuBias<P>& bias) {
    const ImuDelta<P> d = interval.corrected(bias);
    p_by_gyro = add_scaled<P>(p_by_gyro, d.dt, v_by_gyro) + times_skew<P>(R, -d.p) * R_by_gyro +
                R * interval.position_by_gyro();
    p_by_accel = add_scaled<P>(p_by_accel, d.dt, v_by_accel) + R * interval.position_by_accel();
    v_by_gyro = v_by_gyro + times_skew<P>(R, -d.v) * R_by_gyro + R * interval.velocity_by_gyro();
    v_by_accel = v_by_accel + R * interval.velocity_by_accel();
    R_by_gyro = transpose(d.R) * R_by_gyro + interval.rotation_by_gyro();
    p = p + v * d.dt + R * d.p;
    v = v + R * d.v;
    R = R * d.R;
    time += d.dt;
  }
};

}  // namespace

template <class P>
void carry(const Window<P>& window, const CarriedFrom<P>& from, const CarriedPoses<P>& to) {
  using F = typename P::F32;
  const typename P::Function function("carry");
  const Vec3<P>& lever_arm = window.lever_arm;
  Sum<P> sum;
  for (int k : P::range(0, window.keyframes)) {
    if (k > 0) sum.add(window.interval(k), from.bias);
    const Vec3<P> fallen = from.gravity * sum.time;
    const Vec3<P> imu = lever_arm + (from.velocity + fallen * F(0.5f)) * sum.time + sum.p;
    to.store(
        k, {sum.R, imu - sum.R * lever_arm, from.velocity + fallen + sum.v, sum.time, sum.R_by_gyro,
            sum.p_by_gyro + times_skew<P>(sum.R, lever_arm) * sum.R_by_gyro, sum.p_by_accel});
  }
}

template void carry(const Window<work::Native>&, const CarriedFrom<work::Native>&,
                    const CarriedPoses<work::Native>&);
template void carry(const Window<work::Counting>&, const CarriedFrom<work::Counting>&,
                    const CarriedPoses<work::Counting>&);

}  // namespace leviosim::vio
