// The points of a group of a plan, in an order that depends on nothing but the plan.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/app/study/sweep/plan.h"

namespace leviosim::tools {

/// A sweep has no more points than this.
inline constexpr std::size_t kMostPoints = 100'000;

/// One dimension of `count` points of the unit cube, drawn evenly, in [0, 1). A point does not
/// depend on how many there are.
std::vector<double> random_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// One dimension of a Latin hypercube (McKay, Beckman and Conover, Technometrics 21(2), 1979): if
/// it is cut into `count` equal strata, every stratum holds exactly one point.
std::vector<double> latin_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// The rows of a group: the last key of a grid and the last member vary fastest.
/// @throws InputError for more than kMostPoints, Interrupted
std::vector<SweepRow> rows_of(const SweepGroup& group);

}  // namespace leviosim::tools
