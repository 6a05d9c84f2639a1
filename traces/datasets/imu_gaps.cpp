#include "traces/datasets/imu_gaps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

constexpr double kGapSlack = 1.01;  // recorded stamps jitter by a few hundred nanoseconds

double seconds_of(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

/// "frames 0:121 or 130:600 lie on one side of it", numbered as they were chosen.
std::string sides_of(const Dataset& data, std::int64_t from_ns, std::int64_t to_ns) {
  const auto frame_after = [&](std::int64_t t_ns) {
    return std::upper_bound(data.frames.begin(), data.frames.end(), t_ns,
                            [](std::int64_t t, const FrameRef& f) { return t < f.t_ns; }) -
           data.frames.begin();
  };
  const auto offset = static_cast<std::ptrdiff_t>(data.first_frame);
  const std::ptrdiff_t before = frame_after(from_ns), after = frame_after(to_ns - 1);
  const auto count = static_cast<std::ptrdiff_t>(data.frames.size());
  std::string sides;
  if (before > 0) sides = fmt::format("--frames {}:{}", offset, offset + before);
  if (after < count)
    sides += fmt::format("{}--frames {}:{}", sides.empty() ? "" : " or ", offset + after,
                         offset + count);
  return sides;
}

[[noreturn]] void refuse(const Dataset& data, const ImuSample& from, const ImuSample& to) {
  throw InputError(fmt::format(
      "{}: IMU gap of {:.3f} ms between {} ns and {} ns, of which at most {:g} ms are bridged; "
      "expected frames on one side of it: {}",
      data.imu_csv.string(), seconds_of(to.t_ns - from.t_ns) * 1e3, from.t_ns, to.t_ns,
      kLongestBridgedGapS * 1e3, sides_of(data, from.t_ns, to.t_ns)));
}

void append_bridge(const ImuSample& from, const ImuSample& to, double period_s,
                   std::vector<ImuSample>& samples) {
  const auto steps =
      std::max<std::int64_t>(1, std::llround(seconds_of(to.t_ns - from.t_ns) / period_s));
  for (std::int64_t k = 1; k < steps; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(steps);
    samples.push_back({from.t_ns + (to.t_ns - from.t_ns) * k / steps,
                       from.gyro + share * (to.gyro - from.gyro),
                       from.accel + share * (to.accel - from.accel)});
  }
}

}  // namespace

void bridge_imu_gaps(Dataset& data, double longest_periods) {
  const double period_s = 1 / data.imu_model.rate_hz;
  std::vector<ImuSample> samples;
  std::size_t bridged = 0;
  double longest_s = 0;
  for (const ImuSample& to : data.imu) {
    if (!samples.empty()) {
      const ImuSample from = samples.back();
      const double gap_s = seconds_of(to.t_ns - from.t_ns);
      const bool matters =
          to.t_ns > data.frames.front().t_ns && from.t_ns < data.frames.back().t_ns;
      if (matters && gap_s > longest_periods * period_s * kGapSlack) {
        if (gap_s > kLongestBridgedGapS) refuse(data, from, to);
        append_bridge(from, to, period_s, samples);
        ++bridged;
        longest_s = std::max(longest_s, gap_s);
      }
    }
    samples.push_back(to);
  }
  if (bridged == 0) return;
  data.imu = std::move(samples);
  data.notes.push_back(fmt::format(
      "{}: {} of the IMU, the longest {:.1f} ms, bridged by samples on a line between the ends",
      data.imu_csv.string(), bridged == 1 ? "a gap" : fmt::format("{} gaps", bridged),
      longest_s * 1e3));
}

}  // namespace leviosim::traces
