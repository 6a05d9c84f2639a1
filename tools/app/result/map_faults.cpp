#include "tools/app/result/map_faults.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace leviosim::tools {
namespace {

/// Root mean square of the distances from their mean. [m]
template <class Position>
double spread(const std::vector<traces::MatchedPose>& poses, const Position& position) {
  const auto count = static_cast<double>(poses.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const traces::MatchedPose& pose : poses) mean += position(pose) / count;
  double sum = 0;
  for (const traces::MatchedPose& pose : poses) sum += (position(pose) - mean).squaredNorm();
  return std::sqrt(sum / count);
}

/// Size of the estimated path over that of the true one.
double scale_of(const std::vector<traces::MatchedPose>& poses) {
  using Pose = traces::MatchedPose;
  return spread(poses, [](const Pose& pose) { return pose.estimate.translation(); }) /
         spread(poses, [](const Pose& pose) { return pose.truth.translation(); });
}

/// The longest time from a pose to the last of its successors that all come from `source`.
double longest_s(const RunResult& run, PoseSource source) {
  std::int64_t longest_ns = 0;
  for (std::size_t i = 1, known = 0; i < run.frames.size(); ++i) {
    if (run.frames[i].source != source)
      known = i;
    else
      longest_ns = std::max(longest_ns, run.frames[i].t_ns - run.frames[known].t_ns);
  }
  return static_cast<double>(longest_ns) * 1e-9;
}

double duration_s(const RunResult& run) {
  return run.frames.empty()
             ? 0
             : static_cast<double>(run.frames.back().t_ns - run.frames.front().t_ns) * 1e-9;
}

}  // namespace

std::int64_t map_restarts(const RunResult& run) {
  std::int64_t restarts = 0;
  for (const FrameResult& frame : run.frames) restarts += frame.map_restarts;
  return restarts;
}

std::vector<std::string> map_faults(const RunResult& run, const MapLimits& limits) {
  std::vector<std::string> faults;
  if (run.ate && run.ate->path_length_m >= limits.shortest_path_m) {
    const double share = run.ate->translation.rmse / run.ate->path_length_m;
    if (share > limits.error_share)
      faults.push_back(fmt::format("the error is {:.1f} % of the path", 100 * share));
    if (!run.ate->poses.empty()) {
      const double scale = scale_of(run.ate->poses);
      if (!(scale < limits.scale && scale > 1 / limits.scale))
        faults.push_back(fmt::format("the scale is {:.2f}", scale));
    }
  }
  if (const double kept = longest_s(run, PoseSource::Kept); kept > limits.kept_s)
    faults.push_back(fmt::format("the pose was kept for {:.1f} s", kept));
  if (const double waits = longest_s(run, PoseSource::Initialising); waits > limits.initialising_s)
    faults.push_back(fmt::format("the initialisation took {:.1f} s", waits));
  if (const std::int64_t restarts = map_restarts(run);
      restarts > 2 && static_cast<double>(restarts) > limits.restarts_per_s * duration_s(run))
    faults.push_back(fmt::format("the map was begun anew {} times", restarts));
  if (run.poses_left_out > 0) faults.push_back(fmt::format("{} poses are NaN", run.poses_left_out));
  return faults;
}

}  // namespace leviosim::tools
