// Natural cubic smoothing splines through samples at any rising times (Reinsch, "Smoothing by
// spline functions", 1967; Green and Silverman, "Nonparametric Regression and Generalized Linear
// Models", 1994, ch. 2): of all curves the one that minimises
//   sum (y_i - g(t_i))² + alpha ∫ g''(t)² dt,
// a cubic between samples with two continuous derivatives, and zero curvature at both ends. With
// alpha = 0 it interpolates. For evenly spaced samples it is a zero-phase low-pass with the gain
// 1 / (1 + (f / f_half)⁴), which is how alpha is chosen here.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <limits>
#include <vector>

namespace leviosim::traces {

/// Value and derivatives with respect to time, one entry per column of the samples.
struct SplineState {
  Eigen::VectorXd value;
  Eigen::VectorXd first;
  Eigen::VectorXd second;
};

class SmoothingSpline {
 public:
  static constexpr double kInterpolate = std::numeric_limits<double>::infinity();

  /// `times` [s] rise strictly; row i of `samples` belongs to times[i]; at least two.
  /// `half_gain_hz` is the frequency f_half above, or kInterpolate.
  SmoothingSpline(std::vector<double> times, Eigen::MatrixXd samples,
                  double half_gain_hz = kInterpolate);

  /// At any time; beyond the ends the spline goes on along straight lines.
  SplineState at(double t_s) const;

 private:
  /// Solves for the curvatures and moves the values onto the spline.
  void fit(double alpha);

  std::vector<double> times_;
  Eigen::MatrixXd values_;      // of the spline at the times
  Eigen::MatrixXd curvatures_;  // its second derivatives there
};

}  // namespace leviosim::traces
