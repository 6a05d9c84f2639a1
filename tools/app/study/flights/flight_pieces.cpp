#include "tools/app/study/flights/flight_pieces.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"

namespace leviosim::tools {
namespace {

using traces::FrameRange;

using traces::StampedPose;

using traces::Trajectory;

Trajectory::const_iterator sample_at(const Trajectory& truth, std::int64_t t_ns) {
  return std::partition_point(truth.begin(), truth.end(),
                              [&](const StampedPose& pose) { return pose.t_ns < t_ns; });
}

/// Over the second after a time, or over what there is of it. [m/s]
double mean_speed(const Trajectory& truth, std::int64_t t_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t end_ns = std::min(t_ns + kSecond, truth.back().t_ns);
  if (end_ns <= t_ns) return 0;
  return true_path_m(truth, t_ns, end_ns) / (static_cast<double>(end_ns - t_ns) * 1e-9);
}

}  // namespace

double true_path_m(const Trajectory& truth, std::int64_t begin_ns, std::int64_t end_ns) {
  double length = 0;
  auto from = sample_at(truth, begin_ns);
  for (auto to = from; to != truth.end() && to->t_ns <= end_ns; from = to++)
    length += (to->T_world_body.translation() - from->T_world_body.translation()).norm();
  return length;
}

Starts starts_in_motion(const std::vector<std::int64_t>& stamps_ns, const Trajectory& truth,
                        double every_s) {
  check(!stamps_ns.empty() && !truth.empty() && every_s > 0, "a flight, and a time between starts");
  Starts starts;
  const double every_ns = every_s * 1e9;
  double multiple = 1;
  for (std::size_t number = 1; number < stamps_ns.size(); ++number) {
    const auto since_ns = static_cast<double>(stamps_ns[number] - stamps_ns.front());
    if (since_ns < std::round(multiple * every_ns)) continue;
    if (mean_speed(truth, stamps_ns[number]) < kLeastSpeed)
      ++starts.at_rest;
    else
      starts.frames.push_back(number);
    multiple = std::max(multiple, std::floor(since_ns / every_ns)) + 1;
  }
  return starts;
}

std::vector<FrameRange> merged(std::vector<FrameRange> ranges) {
  std::sort(ranges.begin(), ranges.end(),
            [](const FrameRange& a, const FrameRange& b) { return a.begin < b.begin; });
  std::vector<FrameRange> result;
  for (const FrameRange& range : ranges)
    if (!result.empty() && range.begin <= result.back().end)
      result.back().end = std::max(result.back().end, range.end);
    else
      result.push_back(range);
  return result;
}

FrameRange within(const std::vector<FrameRange>& merged, const FrameRange& range) {
  std::size_t before = 0;
  for (const FrameRange& whole : merged) {
    if (whole.begin <= range.begin && range.end <= whole.end)
      return {before + range.begin - whole.begin, before + range.end - whole.begin};
    before += whole.end - whole.begin;
  }
  check(false, "the range lies in one of the merged ones");
  return {};
}

}  // namespace leviosim::tools
