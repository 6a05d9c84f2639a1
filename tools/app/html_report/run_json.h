// A run as data of a report: verdict, key figures, facts, and the tables of its folder that charts
// are drawn from. Everything is taken from the files of a run folder, whether they have been
// written or not; what host and time they were made on is left out.
#pragma once

#include "tools/app/comparison/run_record.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {

/// @param record  of the files
/// @throws InputError for files that do not hold what leviosim writes
Json run_json(const RunRecord& record, const RunFiles& files);

}  // namespace leviosim::tools
