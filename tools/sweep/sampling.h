// The points of a group of a plan, in an order that depends on nothing but the plan.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/sweep/plan.h"

namespace leviosim::tools {

/// A sweep has no more points than this.
inline constexpr std::size_t kMostPoints = 1'000'000;

/// `count` points of the unit cube, drawn evenly: [point][dimension] in [0, 1). A point does not
/// depend on how many there are.
std::vector<std::vector<double>> random_cube(std::size_t count, std::size_t dimensions,
                                             std::uint64_t seed);

/// A Latin hypercube (McKay, Beckman and Conover, Technometrics 21(2), 1979): if each dimension is
/// cut into `count` equal strata, every stratum of every dimension holds exactly one point.
std::vector<std::vector<double>> latin_hypercube(std::size_t count, std::size_t dimensions,
                                                 std::uint64_t seed);

/// All points of a group; the last key of a grid and the last member vary fastest.
/// @throws InputError for more than kMostPoints
std::vector<SweepRow> rows_of(const SweepGroup& group);

}  // namespace leviosim::tools
