#include "traces/datasets/dataset.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

constexpr double kGapSlack = 1.01;  // recorded stamps jitter by a few hundred nanoseconds

double to_seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

void select_frames(std::vector<FrameRef>& frames, const FrameRange& range, const fs::path& csv) {
  check_frame_range(range, frames.size(), csv.string());
  frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(range.end), frames.end());
  frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(range.begin));
}

void require_images(const std::vector<FrameRef>& frames, const fs::path& csv) {
  for (const FrameRef& frame : frames) {
    const base::PathKind kind = base::kind_of(frame.path);
    if (kind == base::PathKind::file) continue;
    throw InputError(
        fmt::format("{}: the image {} {}", base::at_line(csv, frame.line), frame.path.string(),
                    kind == base::PathKind::missing ? "does not exist" : "is no regular file"));
  }
}

/// Frames outside the samples by more than `tolerance_s`.
void require_cover(const Dataset& data, double tolerance_s) {
  const auto fail = [&](const FrameRef& frame, std::int64_t edge, const char* where) {
    throw InputError(fmt::format(
        "{}: the frame at {} ns lies {:.4f} s {} IMU sample of {} ({} ns); choose frames that the "
        "IMU covers",
        base::at_line(data.frames_csv, frame.line), frame.t_ns,
        std::abs(to_seconds(frame.t_ns - edge)), where, data.imu_csv.string(), edge));
  };
  const FrameRef& first = data.frames.front();
  const FrameRef& last = data.frames.back();
  if (to_seconds(data.imu.front().t_ns - first.t_ns) > tolerance_s)
    fail(first, data.imu.front().t_ns, "before the first");
  if (to_seconds(last.t_ns - data.imu.back().t_ns) > tolerance_s)
    fail(last, data.imu.back().t_ns, "after the last");
}

void require_no_gaps(const Dataset& data, double longest_s) {
  for (std::size_t i = 1; i < data.imu.size(); ++i) {
    const std::int64_t from = data.imu[i - 1].t_ns;
    const std::int64_t to = data.imu[i].t_ns;
    if (to <= data.frames.front().t_ns || from >= data.frames.back().t_ns) continue;
    if (to_seconds(to - from) > longest_s * kGapSlack)
      throw InputError(fmt::format(
          "{}: IMU gap of {:.3f} ms between {} ns and {} ns; at most {:.3f} ms is allowed "
          "({:g} Hz sensor)",
          data.imu_csv.string(), to_seconds(to - from) * 1e3, from, to, longest_s * 1e3,
          data.imu_model.rate_hz));
  }
}

/// Units that were mixed up would look like an odometry that is lost.
void require_si_units(const Dataset& data) {
  constexpr double kLeastForce = 3, kMostForce = 100, kMostRate = 12;  // m/s², rad/s
  if (data.imu.empty()) return;
  const auto median_size = [&](Eigen::Vector3d ImuSample::*of) {
    std::vector<double> sizes;
    for (const ImuSample& sample : data.imu) sizes.push_back((sample.*of).norm());
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
  };
  const double force = median_size(&ImuSample::accel), rate = median_size(&ImuSample::gyro);
  if (force < kLeastForce || force > kMostForce)
    throw InputError(fmt::format(
        "{}: half of the accelerations are {} {:.3g} m/s²; expected some 9.8 m/s², which gravity "
        "has at rest{}",
        data.imu_csv.string(), force < kLeastForce ? "at most" : "at least", force,
        std::abs(force - 1) < 0.5 ? " (are they in g?)" : ""));
  if (rate > kMostRate)
    throw InputError(fmt::format(
        "{}: half of the angular rates are at least {:.3g} rad/s; expected at most {:g} "
        "rad/s (are they in °/s?)",
        data.imu_csv.string(), rate, kMostRate));
}

}  // namespace

double rate_of(const std::vector<std::int64_t>& stamps_ns, const fs::path& file) {
  if (stamps_ns.size() < 2)
    throw InputError(
        fmt::format("{}: one time stamp is no rate; expected at least 2 rows", file.string()));
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i)
    periods.push_back(stamps_ns[i] - stamps_ns[i - 1]);
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return 1e9 / static_cast<double>(*middle);
}

std::vector<std::int64_t> stamps_of(const std::vector<FrameRef>& frames) {
  std::vector<std::int64_t> stamps_ns;
  for (const FrameRef& frame : frames) stamps_ns.push_back(frame.t_ns);
  return stamps_ns;
}

Dataset opened(Dataset data, const OpenOptions& options) {
  if (options.frames) select_frames(data.frames, *options.frames, data.frames_csv);
  require_images(data.frames, data.frames_csv);
  if (!data.imu.empty()) {
    const double period_s = 1 / data.imu_model.rate_hz;
    require_cover(data, options.imu_edge_periods * period_s);
    require_no_gaps(data, options.max_imu_gap_periods * period_s);
    require_si_units(data);
  }
  disturb(data, options.disturbance);
  return data;
}

namespace {

bool parse_index(std::string_view text, std::size_t& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

FrameRange parse_frame_range(std::string_view text) {
  FrameRange range;
  const auto colon = text.find(':');
  if (colon == std::string_view::npos || !parse_index(text.substr(0, colon), range.begin) ||
      !parse_index(text.substr(colon + 1), range.end) || range.begin >= range.end)
    throw InputError(fmt::format(
        "frame range '{}': expected A:B with 0 <= A < B (B exclusive), e.g. 0:100", text));
  return range;
}

void check_frame_range(const FrameRange& range, std::size_t count, std::string_view what) {
  if (range.begin >= range.end || range.end > count)
    throw InputError(fmt::format("frame range {}:{}: {} has {} frames, so at most 0:{}",
                                 range.begin, range.end, what, count, count));
}

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
