// A comparison on one screen: figures of the run, the stages that differ most, and the main causes.
#pragma once

#include <string>

#include "tools/app/comparison/comparison.h"

namespace leviosim::tools {

/// At most 24 lines of 80 columns: figures of the run, the stages that differ most, and the main
/// causes. More lines only for notes.
std::string comparison_summary(const RunComparison& comparison);

}  // namespace leviosim::tools
