// What `leviosim sweep` prints when it is done.
#pragma once

#include <string>

#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

/// How many points are done, which failed and which are open, and the Pareto front.
std::string sweep_report(SweepStore& store);

}  // namespace leviosim::tools
