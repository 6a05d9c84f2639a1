// Which kinds of kernel (sim/work/offload_regions.h) the routines of this folder are, and how large
// a call is.
#pragma once

#include <optional>

#include "sim/work/offload_regions.h"

namespace leviosim::vio {

/// Eigenvectors of a symmetric n×n matrix; none for sizes that nobody would build a unit for.
constexpr std::optional<work::OffloadKind> eigen_of_size(int n) {
  switch (n) {
    case 3:
      return work::OffloadKind::Eigen3;
    case 9:
      return work::OffloadKind::Eigen9;
    case 12:
      return work::OffloadKind::Eigen12;
    default:
      return std::nullopt;
  }
}

/// Linear equations in n unknowns; none if so few that a core is done before it had started a unit.
constexpr std::optional<work::OffloadKind> solve_of_size(int n) {
  if (n < 12) return std::nullopt;
  return work::OffloadKind::Solve;
}

/// Size of a factorisation of m equations in n unknowns, and of a substitution.
constexpr int factor_items(int m, int n) { return m * n * n; }
constexpr int substitution_items(int m, int n) { return m * n; }

}  // namespace leviosim::vio
