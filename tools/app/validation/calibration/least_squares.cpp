#include "tools/app/validation/calibration/least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The unknowns run from 0 to 1 across the box.
constexpr int kMaxSteps = 200;
constexpr double kDifference = 1e-6;  ///< of the derivatives
constexpr double kSettled = 1e-10;    ///< largest move of an unknown at the end
constexpr double kMostDamping = 1e12;

class Problem {
 public:
  Problem(const Residuals& residuals, const Box& box) : residuals_(residuals), box_(box) {}

  Eigen::Index size() const { return static_cast<Eigen::Index>(box_.low.size()); }

  std::vector<double> in_units(const VectorXd& x) const {
    std::vector<double> values(box_.low.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::clamp(box_.low[i] + x[static_cast<Eigen::Index>(i)] * width(i), box_.low[i],
                             box_.high[i]);
    return values;
  }

  VectorXd from_units(const std::vector<double>& values) const {
    VectorXd x(size());
    for (std::size_t i = 0; i < values.size(); ++i)
      x[static_cast<Eigen::Index>(i)] = width(i) > 0 ? (values[i] - box_.low[i]) / width(i) : 0;
    return x.cwiseMax(0.0).cwiseMin(1.0);
  }

  VectorXd residuals(const VectorXd& x) const {
    throw_if_interrupted();
    const std::vector<double> r = residuals_(in_units(x));
    return Eigen::Map<const VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
  }

  MatrixXd jacobian(const VectorXd& x) const {
    MatrixXd j(residuals(x).size(), size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      VectorXd above = x;
      VectorXd below = x;
      above[i] = std::min(x[i] + kDifference, 1.0);
      below[i] = std::max(x[i] - kDifference, 0.0);
      j.col(i) = (residuals(above) - residuals(below)) / (above[i] - below[i]);
    }
    return j;
  }

 private:
  double width(std::size_t i) const { return box_.high[i] - box_.low[i]; }

  const Residuals& residuals_;
  const Box& box_;
};

/// The damped step, with the unknowns held that stand at a bound and are pushed outwards.
VectorXd step(const VectorXd& x, const MatrixXd& j, const VectorXd& r, double damping) {
  const VectorXd gradient = j.transpose() * r;
  MatrixXd normal = j.transpose() * j;
  normal.diagonal() *= 1 + damping;
  normal.diagonal().array() += 1e-14;  // an unknown without effect stays where it is
  VectorXd right = -gradient;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool held = (x[i] <= 0 && gradient[i] >= 0) || (x[i] >= 1 && gradient[i] <= 0);
    if (!held) continue;
    normal.row(i).setZero();
    normal.col(i).setZero();
    normal(i, i) = 1;
    right[i] = 0;
  }
  return normal.ldlt().solve(right);
}

Fit descend(const Problem& problem, VectorXd x) {
  VectorXd r = problem.residuals(x);
  double damping = 1e-3;
  for (int k = 0; k < kMaxSteps && damping < kMostDamping; ++k) {
    const VectorXd delta = step(x, problem.jacobian(x), r, damping);
    const VectorXd next = (x + delta).cwiseMax(0.0).cwiseMin(1.0);
    const VectorXd r_next = problem.residuals(next);
    if (r_next.squaredNorm() < r.squaredNorm()) {
      const double moved = (next - x).cwiseAbs().maxCoeff();
      x = next;
      r = r_next;
      damping = std::max(damping / 10, 1e-12);
      if (moved < kSettled) break;
    } else {
      damping *= 10;
    }
  }
  return {problem.in_units(x), r.squaredNorm()};
}

}  // namespace

Fit least_squares(const Residuals& residuals, const Box& box, const std::vector<double>& start) {
  check_equal(box.low.size(), start.size(), "lower bounds");
  check_equal(box.high.size(), start.size(), "upper bounds");
  const Problem problem(residuals, box);
  Fit best = descend(problem, problem.from_units(start));
  for (unsigned corner = 0; corner < 1u << start.size(); ++corner) {
    VectorXd x(problem.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = corner >> i & 1u ? 0.75 : 0.25;
    Fit fit = descend(problem, x);
    // Of points that are as good, the one found first is kept.
    if (fit.cost < best.cost - 1e-12 * (1 + best.cost)) best = std::move(fit);
  }
  return best;
}

}  // namespace leviosim::tools
