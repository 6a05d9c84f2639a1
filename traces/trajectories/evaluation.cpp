#include "traces/trajectories/evaluation.h"

#include <fmt/core.h>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/units.h"
#include "traces/trajectories/association.h"
#include "traces/trajectories/trajectory_alignment.h"

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

/// What moves less rests.
constexpr double kLeastSize_m = 1e-3;

/// RMS distance of positions from their mean.
double size_of(const std::vector<MatchedPose>& poses, Eigen::Isometry3d MatchedPose::*of) {
  const auto count = static_cast<double>(poses.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MatchedPose& pose : poses) mean += (pose.*of).translation() / count;
  double sum = 0;
  for (const MatchedPose& pose : poses) sum += ((pose.*of).translation() - mean).squaredNorm();
  return std::sqrt(sum / count);
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

namespace {

/// " (from 1.000 to 2.500 s)": clocks that differ are seen at once.
std::string span_of(const Trajectory& trajectory) {
  if (trajectory.empty()) return {};
  const auto seconds = [](const StampedPose& pose) {
    return static_cast<double>(pose.t_ns) * 1e-9;
  };
  return fmt::format(" (from {:.3f} to {:.3f} s)", seconds(trajectory.front()),
                     seconds(trajectory.back()));
}

}  // namespace

Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options) {
  Evaluation result;
  result.poses = associate(estimate, truth, options.max_gap_ns);
  if (result.poses.empty())
    throw InputError(
        fmt::format("none of the {} estimated poses{} lies within {:g} ms of one of the {} "
                    "ground-truth poses{}",
                    estimate.size(), span_of(estimate), milliseconds(options.max_gap_ns),
                    truth.size(), span_of(truth)));
  for (const MatchedPose& pose : result.poses)
    if (!pose.estimate.matrix().allFinite()) throw NotComparable("an estimated pose is no number");
  if (const double size = size_of(result.poses, &MatchedPose::truth); size > kLeastSize_m)
    result.size_ratio = size_of(result.poses, &MatchedPose::estimate) / size;
  throw_if_interrupted();
  result.alignment = alignment_of(result.poses, options.alignment);
  align(result.poses, result.alignment);
  result.matched = result.poses.size();
  result.estimates = estimate.size();
  if (options.stamps == Stamps::time) result.longest_gap_s = longest_gap(result.poses);
  result.distances_m = distances_along(truth, result.poses);
  result.path_length_m = result.distances_m.back();
  throw_if_interrupted();
  measure_errors(result);
  throw_if_interrupted();
  const std::string completion = completion_words(truth, options, result);
  result.protocol = fmt::format("{}, {}, {}, {:.2f} m of path", aligned_words(options.alignment),
                                matched_words(result, options), completion, result.path_length_m);
  return result;
}

void require_truth_at(const Trajectory& truth, const std::filesystem::path& file,
                      const std::vector<std::int64_t>& stamps_ns) {
  constexpr std::size_t kFewest = 3;
  if (truth.empty() || stamps_ns.size() < kFewest) return;
  Trajectory frames;
  for (const std::int64_t t_ns : stamps_ns) frames.push_back({t_ns, {}});
  const EvaluationOptions how;
  const std::size_t matched = associate(frames, truth, how.max_gap_ns).size();
  if (matched >= kFewest) return;
  throw InputError(fmt::format(
      "{}: {} of the {} frames ({} to {} ns) {} a true pose within {:g} ms; expected at least {}, "
      "or no ground truth (it spans {} to {} ns)",
      file.string(), matched == 0 ? "none" : fmt::format("{}", matched), stamps_ns.size(),
      stamps_ns.front(), stamps_ns.back(), matched > 1 ? "have" : "has",
      static_cast<double>(how.max_gap_ns) * 1e-6, kFewest, truth.front().t_ns, truth.back().t_ns));
}

namespace {

struct AlignmentRow {
  Alignment alignment;
  std::string_view option;
  std::string_view name;
  std::size_t least_points;
};

constexpr std::array<AlignmentRow, 4> kAlignments{{
    {Alignment::none, "none", "none", 0},
    {Alignment::se3, "se3", "SE3", 3},
    {Alignment::sim3, "sim3", "Sim3", 3},
    {Alignment::posyaw, "posyaw", "PosYaw", 2},
}};

const AlignmentRow& row_of(Alignment alignment) {
  return kAlignments[static_cast<std::size_t>(alignment)];
}

/// First and second moments of two point sets.
struct Moments {
  Eigen::Vector3d mean_from = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_to = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of to and from
  double variance_from = 0;
};

Moments moments_of(const std::vector<Eigen::Vector3d>& from,
                   const std::vector<Eigen::Vector3d>& to) {
  Moments m;
  const auto count = static_cast<double>(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    m.mean_from += from[i] / count;
    m.mean_to += to[i] / count;
  }
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d a = from[i] - m.mean_from;
    const Eigen::Vector3d b = to[i] - m.mean_to;
    m.covariance += b * a.transpose() / count;
    m.variance_from += a.squaredNorm() / count;
  }
  return m;
}

/// Rotation about z that maximises trace(Rᵀ covariance).
Similarity yaw_only(const Moments& m) {
  const double yaw =
      std::atan2(m.covariance(1, 0) - m.covariance(0, 1), m.covariance(0, 0) + m.covariance(1, 1));
  Similarity result;
  result.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return result;
}

/// Umeyama 1991, equations 38 to 43.
Similarity full_rotation(const Moments& m, bool with_scale) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  Similarity result;
  result.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  if (!with_scale) return result;
  if (!(m.variance_from > 0))
    throw NotComparable("Sim3 alignment: all estimated positions coincide, so there is no scale");
  result.scale = svd.singularValues().dot(signs) / m.variance_from;
  return result;
}

}  // namespace

std::string_view name_of(Alignment alignment) { return row_of(alignment).name; }

Alignment parse_alignment(std::string_view name) {
  for (const AlignmentRow& row : kAlignments)
    if (row.option == name) return row.alignment;
  throw InputError(fmt::format("alignment '{}': expected one of none, se3, sim3, posyaw", name));
}

Similarity align_points(const std::vector<Eigen::Vector3d>& from,
                        const std::vector<Eigen::Vector3d>& to, Alignment alignment) {
  check_equal(from.size(), to.size(), "align_points: number of points");
  if (alignment == Alignment::none) return {};
  const AlignmentRow& row = row_of(alignment);
  if (from.size() < row.least_points)
    throw InputError(fmt::format("{} alignment needs at least {} matched poses; there are {}",
                                 row.name, row.least_points, from.size()));
  const Moments m = moments_of(from, to);
  if (!m.covariance.allFinite() || !std::isfinite(m.variance_from))  // where an SVD means nothing
    throw NotComparable("the positions are too large to be compared; expected metres");
  Similarity result =
      alignment == Alignment::posyaw ? yaw_only(m) : full_rotation(m, alignment == Alignment::sim3);
  result.translation = m.mean_to - result.scale * (result.rotation * m.mean_from);
  return result;
}

}  // namespace leviosim::traces
