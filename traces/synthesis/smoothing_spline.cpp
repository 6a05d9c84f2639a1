#include "traces/synthesis/smoothing_spline.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "sim/base/angles.h"
#include "sim/base/check.h"

namespace leviosim::traces {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Q of Green and Silverman (n x n-2): its transpose takes second differences.
Sparse second_differences(const Eigen::VectorXd& steps) {
  const Eigen::Index inner = steps.size() - 1;
  Triplets entries;
  for (Eigen::Index j = 0; j < inner; ++j) {
    entries.emplace_back(j, j, 1 / steps[j]);
    entries.emplace_back(j + 1, j, -1 / steps[j] - 1 / steps[j + 1]);
    entries.emplace_back(j + 2, j, 1 / steps[j + 1]);
  }
  Sparse q(inner + 2, inner);
  q.setFromTriplets(entries.begin(), entries.end());
  return q;
}

/// R of Green and Silverman (n-2 x n-2): g R g is the integral of the squared curvature.
Sparse curvature_products(const Eigen::VectorXd& steps) {
  const Eigen::Index inner = steps.size() - 1;
  Triplets entries;
  for (Eigen::Index j = 0; j < inner; ++j) {
    entries.emplace_back(j, j, (steps[j] + steps[j + 1]) / 3);
    if (j + 1 == inner) break;
    entries.emplace_back(j, j + 1, steps[j + 1] / 6);
    entries.emplace_back(j + 1, j, steps[j + 1] / 6);
  }
  Sparse r(inner, inner);
  r.setFromTriplets(entries.begin(), entries.end());
  return r;
}

}  // namespace

SmoothingSpline::SmoothingSpline(std::vector<double> times, Eigen::MatrixXd samples,
                                 double half_gain_hz)
    : times_(std::move(times)), values_(std::move(samples)) {
  check(times_.size() >= 2, "SmoothingSpline: at least two samples");
  check(half_gain_hz > 0, "SmoothingSpline: half_gain_hz above 0");
  check_equal(times_.size(), static_cast<std::size_t>(values_.rows()), "SmoothingSpline: samples");
  const double period_s = (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
  // The penalty weighs an integral against a sum, hence the sampling period.
  fit(std::isinf(half_gain_hz) ? 0 : 1 / (period_s * std::pow(base::kTwoPi * half_gain_hz, 4)));
}

void SmoothingSpline::fit(double alpha) {
  curvatures_.setZero(values_.rows(), values_.cols());
  const Eigen::Index inner = values_.rows() - 2;
  if (inner == 0) return;
  const Eigen::Map<const Eigen::VectorXd> t(times_.data(), values_.rows());
  const Eigen::VectorXd steps = t.tail(inner + 1) - t.head(inner + 1);
  check(steps.minCoeff() > 0, "SmoothingSpline: times rise");
  const Sparse q = second_differences(steps);
  const Sparse normal = curvature_products(steps) + alpha * Sparse(q.transpose() * q);
  const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> solver(normal);
  check(solver.info() == Eigen::Success, "SmoothingSpline: positive definite");
  const Eigen::MatrixXd differences = q.transpose() * values_;
  const Eigen::MatrixXd inner_curvatures = solver.solve(differences);
  values_ -= alpha * (q * inner_curvatures);
  curvatures_.middleRows(1, inner) = inner_curvatures;
}

SplineState SmoothingSpline::at(double t_s) const {
  const auto right = std::upper_bound(times_.begin() + 1, times_.end() - 1, t_s);
  const Eigen::Index i = right - times_.begin() - 1;
  const double from = times_[static_cast<std::size_t>(i)];
  const double h = *right - from;
  const double inside = std::clamp(t_s, from, *right);
  const double b = (inside - from) / h;
  const double a = 1 - b;
  const auto row = [](const Eigen::MatrixXd& m, Eigen::Index r) -> Eigen::VectorXd {
    return m.row(r);
  };
  const Eigen::VectorXd v0 = row(values_, i), v1 = row(values_, i + 1);
  const Eigen::VectorXd c0 = row(curvatures_, i), c1 = row(curvatures_, i + 1);
  SplineState state;
  state.first = (v1 - v0) / h + h / 6 * ((1 - 3 * a * a) * c0 + (3 * b * b - 1) * c1);
  state.value = a * v0 + b * v1 + h * h / 6 * (a * (a * a - 1) * c0 + b * (b * b - 1) * c1) +
                (t_s - inside) * state.first;
  state.second = a * c0 + b * c1;
  return state;
}

}  // namespace leviosim::traces
