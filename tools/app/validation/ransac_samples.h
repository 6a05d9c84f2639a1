// How many iterations each hypothesis of both RANSACs of `levio` took, from what was counted in it:
// a fork hands one hypothesis to each core. Facts: workload/PARAMETERS.md#epnp,
// #eight-point-algorithm.
#pragma once

#include <vector>

#include "sim/work/program.h"

namespace leviosim::tools {

struct RansacSamples {
  /// The only double arithmetic of a hypothesis is in Jacobi rotations, two products in each.
  std::vector<double> epnp_rotations;  ///< Jacobi rotations of 12×12 and 3×3, per hypothesis
  std::vector<double> eight_point_rotations;  ///< Jacobi rotations of 3×3, per hypothesis
  /// A step has 54 divisions; besides it there are 21 in a hypothesis, and one in a rotation.
  std::vector<double> eight_point_steps;  ///< of 9×9, per hypothesis
  std::vector<double> slowest_of_eight;   ///< the same, the most in a fork

  void add(const work::Job& job);
};

}  // namespace leviosim::tools
