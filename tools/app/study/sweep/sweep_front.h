// What came out of a sweep: its Pareto front as a table with a column for each key that varies, and
// the answer in a sentence.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

/// Titles, then a row for each point of the front: what was set, and the objectives that differ.
/// Empty without a front.
std::vector<std::vector<std::string>> sweep_front(const SweepStore& store);

/// The same as text, and what all points of the front have in common.
std::string front_text(const SweepStore& store);

/// Which point is the fastest, which takes the least energy, and what is missing, in a
/// sentence without an end.
std::string sweep_conclusion(const SweepStore& store);

}  // namespace leviosim::tools
