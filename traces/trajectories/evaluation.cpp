#include "traces/trajectories/evaluation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/angles.h"
#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-9;
}

double milliseconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

std::string aligned_words(Alignment alignment) {
  return alignment == Alignment::none ? "not aligned"
                                      : fmt::format("{}-aligned", name_of(alignment));
}

std::string matched_words(const Evaluation& result, const EvaluationOptions& options) {
  const std::string poses = fmt::format("{} of {} poses matched", result.matched, result.estimates);
  if (options.stamps == Stamps::pose_number) return poses + " by number";
  return fmt::format("{} with interpolated truth (a sample within {:g} ms)", poses,
                     milliseconds(options.max_gap_ns));
}

/// Also sets `completion`, which the words are about.
std::string completion_words(const Trajectory& truth, const EvaluationOptions& options,
                             Evaluation& result) {
  const auto matched = static_cast<double>(result.matched);
  std::string whole = fmt::format("{} expected poses", options.expected_poses);
  if (options.expected_poses > 0) {
    result.completion = matched / static_cast<double>(options.expected_poses);
  } else if (options.stamps == Stamps::pose_number) {
    result.completion = matched / static_cast<double>(truth.size());
    whole = fmt::format("{} true poses", truth.size());
  } else {
    const double duration_s = seconds_between(truth.front().t_ns, truth.back().t_ns);
    const double span_s = seconds_between(result.poses.front().t_ns, result.poses.back().t_ns);
    result.completion = duration_s > 0 ? span_s / duration_s : 1;
    whole = fmt::format("{:.2f} s of truth, longest gap {:.2f} s", duration_s,
                        result.longest_gap_s.value_or(0));
  }
  return fmt::format("completion {:.1f} % ({})", result.completion * 100, whole);
}

double longest_gap(const std::vector<MatchedPose>& poses) {
  double longest_s = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    longest_s = std::max(longest_s, seconds_between(poses[i - 1].t_ns, poses[i].t_ns));
  return longest_s;
}

Similarity alignment_of(const std::vector<MatchedPose>& matches, Alignment alignment) {
  std::vector<Eigen::Vector3d> from;
  std::vector<Eigen::Vector3d> to;
  for (const MatchedPose& match : matches) {
    from.push_back(match.estimate.translation());
    to.push_back(match.truth.translation());
  }
  return align_points(from, to, alignment);
}

void align(std::vector<MatchedPose>& poses, const Similarity& by) {
  for (MatchedPose& pose : poses) {
    const Eigen::Vector3d position = by * pose.estimate.translation();
    const Eigen::Matrix3d rotation = by.rotation * pose.estimate.linear();
    pose.estimate.linear() = rotation;
    pose.estimate.translation() = position;
  }
}

void measure_errors(Evaluation& result) {
  std::vector<double> translation;
  std::vector<double> rotation;
  for (const MatchedPose& pose : result.poses) {
    translation.push_back(translation_error(pose));
    rotation.push_back(rotation_error_deg(pose));
  }
  result.translation = summarize(std::move(translation));
  result.rotation_rmse_deg = summarize(std::move(rotation)).rmse;
  if (!std::isfinite(result.translation.rmse) || !std::isfinite(result.path_length_m))
    throw NotComparable("the positions are too large to be compared; expected metres");
}

}  // namespace

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

double translation_error(const MatchedPose& pose) {
  return (pose.estimate.translation() - pose.truth.translation()).norm();
}

double rotation_error_deg(const MatchedPose& pose) {
  return angle_deg(pose.truth.linear().transpose() * pose.estimate.linear());
}

double angle_deg(const Eigen::Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle() * base::kDegreesPerRadian;
}

Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options) {
  Evaluation result;
  result.poses = associate(estimate, truth, options.max_gap_ns);
  if (result.poses.empty())
    throw InputError(fmt::format(
        "none of the {} estimated poses lies within {:g} ms of one of the {} ground-truth poses",
        estimate.size(), milliseconds(options.max_gap_ns), truth.size()));
  for (const MatchedPose& pose : result.poses)
    if (!pose.estimate.matrix().allFinite()) throw NotComparable("an estimated pose is no number");
  result.alignment = alignment_of(result.poses, options.alignment);
  align(result.poses, result.alignment);
  result.matched = result.poses.size();
  result.estimates = estimate.size();
  if (options.stamps == Stamps::time) result.longest_gap_s = longest_gap(result.poses);
  result.distances_m = distances_along(truth, result.poses);
  result.path_length_m = result.distances_m.back();
  measure_errors(result);
  const std::string completion = completion_words(truth, options, result);
  result.protocol = fmt::format("{}, {}, {}, {:.2f} m of path", aligned_words(options.alignment),
                                matched_words(result, options), completion, result.path_length_m);
  return result;
}

}  // namespace leviosim::traces
