#include "tools/app/result/camera_figures.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"

namespace leviosim::tools {

CameraFigures::Latencies latencies_of(const RunResult& run) {
  std::vector<std::int64_t> sorted;
  for (const FrameResult& frame : run.frames) sorted.push_back(frame.end_ns - frame.arrival_ns);
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  return {percentile(sorted, 0.5), percentile(sorted, 0.95), percentile(sorted, 0.99),
          sorted.back()};
}

double CameraFigures::share_of(std::int64_t frames) const {
  return arrived > 0 ? static_cast<double>(frames) / static_cast<double>(arrived) : 0;
}

bool is_late(const FrameResult& frame, const RunResult& run) {
  return frame.end_ns - frame.arrival_ns > run.frame_period_ns;
}

std::int64_t percentile(const std::vector<std::int64_t>& sorted, double share) {
  constexpr double kRounding = 1e-9;  // 0.95 · 20 is 19, not the number after it
  const double rank = std::ceil(share * static_cast<double>(sorted.size()) - kRounding);
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  check(index < sorted.size(), "a percentile is of values that exist");
  return sorted[index];
}

std::optional<CameraFigures> camera_figures(const RunResult& run) {
  if (!run.camera) return std::nullopt;
  CameraFigures figures;
  figures.arrived = static_cast<std::int64_t>(run.camera->deliveries.size());
  figures.processed = static_cast<std::int64_t>(run.frames.size());
  for (const soc::Delivery& delivery : run.camera->deliveries) {
    if (delivery.dropped) ++figures.dropped;
    figures.most_found = std::max(figures.most_found, delivery.found);
  }
  for (const FrameResult& frame : run.frames) {
    if (is_late(frame, run)) ++figures.late;
    if (frame.start_ns > frame.arrival_ns) ++figures.waited;
  }
  figures.latency = latencies_of(run);
  return figures;
}

}  // namespace leviosim::tools
