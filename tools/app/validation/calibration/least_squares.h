// Least squares between bounds, for a handful of unknowns and smooth residuals: Levenberg–Marquardt
// on the unknowns that are free, with derivatives from finite differences. An unknown at a bound
// that the cost pushes outwards is held there. Started from several points of the box, since what
// is fitted need not be convex. Deterministic.
#pragma once

#include <functional>
#include <vector>

namespace leviosim::tools {

struct Box {
  std::vector<double> low;
  std::vector<double> high;
};

struct Fit {
  std::vector<double> at;
  double cost = 0;  ///< sum of the squared residuals
};

using Residuals = std::function<std::vector<double>(const std::vector<double>&)>;

/// @param start  inside the box; the first of the points from which it is started
Fit least_squares(const Residuals& residuals, const Box& box, const std::vector<double>& start);

}  // namespace leviosim::tools
