#include "sim/soc/camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace leviosim::soc {
namespace {

/// Of a frame number with a fraction, between the stamps around it. [ns]
std::int64_t stamp_at(double number, const std::vector<std::int64_t>& stamps_ns, double period_ns) {
  const auto before = static_cast<std::size_t>(number);
  const double share = number - static_cast<double>(before);
  const double gap_ns = before + 1 < stamps_ns.size()
                            ? static_cast<double>(stamps_ns[before + 1] - stamps_ns[before])
                            : period_ns;
  return stamps_ns[before] + std::llround(share * gap_ns);
}

}  // namespace

const DeadlineInfo& info_of(Deadline deadline) {
  const DeadlineInfo& info = kDeadlines[static_cast<std::size_t>(deadline)];
  check(info.deadline == deadline, "policies stand in their order");
  return info;
}

Deadline parse_deadline(const std::string& text) {
  std::vector<std::string> names;
  for (const DeadlineInfo& info : kDeadlines) {
    if (info.name == text) return info.deadline;
    names.emplace_back(info.name);
  }
  throw InputError(fmt::format("--deadline '{}': expected {}{}", text, fmt::join(names, " or "),
                               base::did_you_mean(text, names)));
}

std::vector<CameraFrame> all_frames(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<CameraFrame> frames;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i)
    frames.push_back({i, stamps_ns[i] - stamps_ns.front()});
  return frames;
}

std::vector<CameraFrame> frames_at(double fps, const std::vector<std::int64_t>& stamps_ns,
                                   double recorded_hz) {
  if (fps > recorded_hz)
    throw InputError(fmt::format(
        "a camera of {:g} frames/s: the flight was recorded at {:g} frames/s, and there "
        "are no pictures in between; expected at most {:g}",
        fps, recorded_hz, recorded_hz));
  const double step = recorded_hz / fps;
  std::vector<CameraFrame> frames;
  for (int k = 0;; ++k) {
    const double number = k * step;
    const double nearest = std::floor(number + 0.5);
    if (nearest >= static_cast<double>(stamps_ns.size())) return frames;
    frames.push_back({static_cast<std::size_t>(nearest),
                      stamp_at(number, stamps_ns, 1e9 / recorded_hz) - stamps_ns.front()});
  }
}

}  // namespace leviosim::soc
