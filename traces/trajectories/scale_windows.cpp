#include "traces/trajectories/scale_windows.h"

#include <Eigen/SVD>

#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/base/check.h"

namespace leviosim::traces {
namespace {

constexpr std::size_t kFewestPoses = 3;  // that an alignment needs

double scale_of(const std::vector<MatchedPose>& poses, std::size_t begin, std::size_t end) {
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
  for (std::size_t i = begin; i < end; ++i) {
    truth.push_back(poses[i].truth.translation());
    estimate.push_back(poses[i].estimate.translation());
  }
  return align_points(truth, estimate, Alignment::sim3).scale;
}

}  // namespace

std::vector<double> scales_in_windows(const Evaluation& evaluation, const ScaleWindows& how) {
  check(how.window_s > 0 && how.shortest_path_m > 0, "windows have a length, paths in them too");
  const std::vector<MatchedPose>& poses = evaluation.poses;
  std::vector<double> scales;
  if (poses.empty()) return scales;
  const auto add = [&](std::size_t begin, std::size_t end) {
    const double path = evaluation.distances_m[end - 1] - evaluation.distances_m[begin];
    if (end - begin >= kFewestPoses && path >= how.shortest_path_m)
      scales.push_back(scale_of(poses, begin, end) / evaluation.alignment.scale);
  };
  const std::int64_t window_ns = std::llround(how.window_s * 1e9);
  std::size_t begin = 0;
  std::int64_t until_ns = poses.front().t_ns + window_ns;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (; poses[i].t_ns >= until_ns; until_ns += window_ns) {
      if (begin < i) add(begin, i);
      begin = i;
    }
  if (begin == 0) add(0, poses.size());
  return scales;
}

ScaleSummary summarize_scales(const std::vector<double>& scales) {
  ScaleSummary summary;
  summary.windows = scales.size();
  const auto count = static_cast<double>(scales.size());
  if (scales.empty()) return summary;
  double sum = 0;
  for (const double scale : scales) sum += scale;
  summary.mean = sum / count;
  if (scales.size() < 2) return summary;
  double squares = 0;
  for (const double scale : scales) squares += (scale - *summary.mean) * (scale - *summary.mean);
  summary.sigma = std::sqrt(squares / (count - 1));
  return summary;
}

}  // namespace leviosim::traces
