// A run as data of a report: verdict, key figures, facts, and the tables of its folder that charts
// are drawn from. Everything is taken from the files of a run folder, whether they have been
// written or not; what host and time they were made on is left out.
#pragma once

#include "tools/app/run/run_folder.h"

namespace leviosim::tools {

/// @throws InputError for tables that do not hold what leviosim writes
Json run_json(const RunFolder& run);

}  // namespace leviosim::tools
