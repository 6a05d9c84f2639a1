// Whether two runs can be compared: they must have processed the same data, frame by frame, with
// the same random draws, at the same size, by the same profile. Anything else may differ; what
// should be known about it is noted.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tools/app/record/record.h"

namespace leviosim::tools {

/// Differences that the user allows: "data,seed".
using Allowed = std::set<std::string>;

/// @throws InputError for names that are none of chip, data, frames, profile, seed, size
Allowed parse_allowed(const std::string& text);

/// @returns notes: what else differs, and what was allowed to
/// @throws InputError naming each difference that is not allowed
std::vector<std::string> check_comparable(const RunRecord& a, const RunRecord& b,
                                          const Allowed& allowed);

/// Of a run and a baseline: limits of one chip say nothing of another. Settings of the chip and the
/// number of cores are what a user tries out, and may differ.
/// @throws InputError unless "chip" is allowed
void check_same_chip(const RunRecord& a, const RunRecord& b, const Allowed& allowed);

}  // namespace leviosim::tools
