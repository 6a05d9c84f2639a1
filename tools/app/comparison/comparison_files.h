// A comparison as JSON and CSV: every quantity of the tree.
#pragma once

#include <string>

#include "tools/app/comparison/comparison.h"

namespace leviosim::tools {

Json comparison_json(const RunComparison& comparison);

/// subject,quantity,part,subpart,unit,a,b,difference; a row per quantity. Cells that hold commas or
/// quotes are quoted (RFC 4180).
std::string comparison_csv(const RunComparison& comparison);

}  // namespace leviosim::tools
