// What `leviosim sweep` prints when it is done.
#pragma once

#include <string>

#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

/// How many points are done, which failed and which are open, and the Pareto front.
std::string sweep_report(SweepStore& store);

/// "0:01:13"
std::string duration_text(double seconds);

/// "point 12/100, 3 of them done before, 4.1 points/s, done in 0:00:21". No time before something
/// was computed.
/// @param done,found  since the start; found in the cache or in the file
std::string sweep_progress(std::int64_t done, std::int64_t found, std::int64_t total,
                           double host_seconds);

}  // namespace leviosim::tools
