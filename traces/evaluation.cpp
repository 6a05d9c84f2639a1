#include "traces/evaluation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/error.h"

namespace leviosim::traces {
namespace {

constexpr double kDegreesPerRadian = 57.295779513082320876798;

bool earlier(const StampedPose& pose, std::int64_t t_ns) { return pose.t_ns < t_ns; }

Eigen::Isometry3d interpolate(const StampedPose& a, const StampedPose& b, std::int64_t t_ns) {
  const double s = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
  const Eigen::Vector3d p =
      (1 - s) * a.T_world_body.translation() + s * b.T_world_body.translation();
  const Eigen::Quaterniond from(a.T_world_body.linear());
  const Eigen::Quaterniond to(b.T_world_body.linear());
  return Eigen::Translation3d(p) * from.slerp(s, to);
}

double rotation_angle(const Eigen::Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle();
}

/// Length of the truth between two times that lie within it.
double path_length(const Trajectory& truth, const MatchedPose& first, const MatchedPose& last) {
  double length = 0;
  Eigen::Vector3d here = first.truth.translation();
  const auto walk_to = [&](const Eigen::Vector3d& there) {
    length += (there - here).norm();
    here = there;
  };
  for (auto sample = std::lower_bound(truth.begin(), truth.end(), first.t_ns, earlier);
       sample != truth.end() && sample->t_ns < last.t_ns; ++sample)
    walk_to(sample->T_world_body.translation());
  walk_to(last.truth.translation());
  return length;
}

std::string protocol_line(const Evaluation& result, const EvaluationOptions& options) {
  const std::string aligned = options.alignment == Alignment::none
                                  ? "not aligned"
                                  : fmt::format("{}-aligned", name_of(options.alignment));
  return fmt::format(
      "{}, {} of {} poses matched within {:g} ms, completion {:.1f} %, {:.2f} m of path", aligned,
      result.matched, result.estimates, static_cast<double>(options.max_gap_ns) * 1e-6,
      result.completion * 100, result.path_length_m);
}

void measure_errors(const std::vector<MatchedPose>& matches, Evaluation& result) {
  std::vector<double> translation;
  std::vector<double> rotation;
  for (const MatchedPose& match : matches) {
    const Eigen::Vector3d position = result.alignment * match.estimate.translation();
    translation.push_back((position - match.truth.translation()).norm());
    rotation.push_back(rotation_angle(match.truth.linear().transpose() * result.alignment.rotation *
                                      match.estimate.linear()));
  }
  result.translation = summarize(std::move(translation));
  result.rotation_rmse_deg = summarize(std::move(rotation)).rmse * kDegreesPerRadian;
}

}  // namespace

std::vector<MatchedPose> associate(const Trajectory& estimate, const Trajectory& truth,
                                   std::int64_t max_gap_ns) {
  std::vector<MatchedPose> matches;
  for (const StampedPose& pose : estimate) {
    const auto right = std::lower_bound(truth.begin(), truth.end(), pose.t_ns, earlier);
    if (right == truth.end()) continue;
    if (right->t_ns == pose.t_ns) {
      matches.push_back({pose.t_ns, pose.T_world_body, right->T_world_body});
      continue;
    }
    if (right == truth.begin()) continue;
    const auto left = right - 1;
    if (std::min(pose.t_ns - left->t_ns, right->t_ns - pose.t_ns) > max_gap_ns) continue;
    matches.push_back({pose.t_ns, pose.T_world_body, interpolate(*left, *right, pose.t_ns)});
  }
  return matches;
}

ErrorSummary summarize(std::vector<double> errors) {
  ErrorSummary summary;
  if (errors.empty()) return summary;
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  double sum_of_squares = 0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  const auto count = static_cast<double>(errors.size());
  summary.rmse = std::sqrt(sum_of_squares / count);
  summary.mean = sum / count;
  summary.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  summary.max = errors.back();
  return summary;
}

Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options) {
  const std::vector<MatchedPose> matches = associate(estimate, truth, options.max_gap_ns);
  if (matches.empty())
    throw InputError(fmt::format(
        "none of the {} estimated poses lies within {:g} ms of one of the {} ground-truth poses",
        estimate.size(), static_cast<double>(options.max_gap_ns) * 1e-6, truth.size()));
  std::vector<Eigen::Vector3d> from;
  std::vector<Eigen::Vector3d> to;
  for (const MatchedPose& match : matches) {
    from.push_back(match.estimate.translation());
    to.push_back(match.truth.translation());
  }

  Evaluation result;
  result.alignment = align_points(from, to, options.alignment);
  result.matched = matches.size();
  result.estimates = estimate.size();
  const std::size_t expected =
      options.expected_poses > 0 ? options.expected_poses : estimate.size();
  result.completion = static_cast<double>(result.matched) / static_cast<double>(expected);
  result.path_length_m = path_length(truth, matches.front(), matches.back());
  measure_errors(matches, result);
  result.protocol = protocol_line(result, options);
  return result;
}

}  // namespace leviosim::traces
