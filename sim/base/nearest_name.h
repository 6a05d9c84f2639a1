// The valid name that a mistyped one most likely stands for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace leviosim::base {

/// The name in `valid` that takes the fewest single-character insertions and deletions to reach
/// from `typed`; the earlier one of equals. Empty if even that one shares less than half of the
/// characters typed. (A replaced character counts as two edits, which favours names that contain
/// what was typed: "cluster.fpus" is nearer to "cluster.fpu.units" than to "cluster.clock".)
std::string nearest(std::string_view typed, const std::vector<std::string>& valid);

/// "; did you mean 'NAME'?", or empty if no name is near.
std::string did_you_mean(std::string_view typed, const std::vector<std::string>& valid);

}  // namespace leviosim::base
