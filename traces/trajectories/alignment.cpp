#include "traces/trajectories/alignment.h"

#include <fmt/core.h>

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::traces {
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
