// Cycles that were measured elsewhere, by the counters of a board or by another simulator, as a
// record that budgets, histories and comparisons take in the place of a run:
//
//   # profile: levio          both lines may be missing; other comments are left alone
//   # platform: gap9
//   stage,cycles,calls        calls may be missing
//   8-point RANSAC,9818116,260
//   frame,15650300
//
// A row is a call, or so many with their mean. Stages have the names or the keys of leviosim; frame
// is the front end as a whole. Left out: times, memory, energy, and where the cycles went.
#pragma once

#include <string>

#include "tools/app/record/record.h"

namespace leviosim::tools {

/// Whether a name is that of a CSV file.
bool is_measured(const std::string& name);

/// @throws InputError naming file, line and column
RunRecord read_measured(const std::string& file);

/// Gives stages of a measurement the names that a run has for their keys; leaves runs as they are.
void name_stages_like(RunRecord& measured, const RunRecord& run);

}  // namespace leviosim::tools
