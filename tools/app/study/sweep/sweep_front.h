// What came out of a sweep: its Pareto front as a table with a column for each key that varies, and
// the answer in a sentence.
#pragma once

#include <string>

#include "tools/app/study/sweep/sweep_store.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

/// "16B/cycle" → "16 B/cycle", "4units" → "4": what is counted says the name of the parameter.
std::string readable_setting(const std::string& value);

/// A row for each point of the front: what was set, and the objectives that differ.
Table sweep_front(const SweepStore& store);

/// The same as text, and what all points of the front have in common.
std::string front_text(const SweepStore& store);

/// Which point is the fastest, which takes the least energy, and what is missing, in a
/// sentence without an end.
std::string sweep_conclusion(const SweepStore& store);

}  // namespace leviosim::tools
