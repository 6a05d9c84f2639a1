// Words that every form of a comparison uses: names of parts, what differs in the work, the parts
// that explain a difference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/comparison/comparison.h"

namespace leviosim::tools {

/// "+1.25 %"; "±0.00 %" for what rounds to zero.
std::string signed_percent(std::optional<double> value);

/// Of a figure, without its unit.
std::string quantity_text(std::optional<double> value, const std::string& unit, int decimals);

/// A part that changes its stage by less explains nothing.
inline constexpr double kLeastShare = 1e-4;

/// The parts of a difference that are listed: all, or those with more cycles in B.
enum class Toward { both, more };

/// "8-point hypotheses: issue +1.2 %": the parts of a stage that explain most of its difference,
/// each with its share of the stage's cycles in A.
/// @param most    of them at most
/// @param toward  more: only parts that take more in B
std::vector<std::string> reasons(const StageComparison& stage, std::size_t most,
                                 Toward toward = Toward::both);

/// The name of a part for people: the description of a mechanism, else the name.
std::string part_label(const std::string& name);

/// One line about the work: the same, or where it is not.
std::string work_line(const RunComparison& comparison);

}  // namespace leviosim::tools
