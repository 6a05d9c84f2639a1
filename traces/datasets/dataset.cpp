#include "traces/datasets/dataset.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/frame_range.h"
#include "traces/datasets/imu_gaps.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

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
  if (options.frames) {
    select_frames(data.frames, *options.frames, data.frames_csv);
    data.first_frame = options.frames->begin;
  }
  require_images(data.frames, data.frames_csv);
  if (!data.imu.empty()) {
    const double period_s = 1 / data.imu_model.rate_hz;
    require_cover(data, options.imu_edge_periods * period_s);
    require_si_units(data);
    bridge_imu_gaps(data, options.max_imu_gap_periods);
  }
  disturb(data, options.disturbance);
  return data;
}

}  // namespace leviosim::traces
