#include "traces/datasets/imu_samples.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "traces/datasets/dataset.h"

namespace leviosim::traces {
namespace {

bool later(std::int64_t t_ns, const ImuSample& sample) { return t_ns < sample.t_ns; }

}  // namespace

std::span<const ImuSample> imu_between(std::span<const ImuSample> samples, std::int64_t after_ns,
                                       std::int64_t up_to_ns) {
  const auto first = std::upper_bound(samples.begin(), samples.end(), after_ns, later);
  const auto last = std::upper_bound(first, samples.end(), up_to_ns, later);
  return samples.subspan(static_cast<std::size_t>(first - samples.begin()),
                         static_cast<std::size_t>(last - first));
}

std::span<const ImuSample> imu_batch(const Dataset& data, std::size_t frame) {
  check(frame < data.frames.size(), "imu_batch: no such frame");
  const std::int64_t t_ns = data.frames[frame].t_ns;
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 / data.camera.rate_hz));
  const std::int64_t after_ns = frame > 0 ? data.frames[frame - 1].t_ns : t_ns - period_ns;
  return imu_between(data.imu, after_ns, t_ns);
}

ImuSample interpolate_imu(std::span<const ImuSample> samples, std::int64_t t_ns) {
  if (samples.empty() || t_ns < samples.front().t_ns || t_ns > samples.back().t_ns)
    throw InputError(fmt::format("no IMU sample around {} ns", t_ns));
  const auto right = std::upper_bound(samples.begin(), samples.end(), t_ns, later);
  const ImuSample& a = *(right - 1);
  if (a.t_ns == t_ns) return a;
  const ImuSample& b = *right;
  const double s = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
  return {t_ns, a.gyro + s * (b.gyro - a.gyro), a.accel + s * (b.accel - a.accel)};
}

}  // namespace leviosim::traces
