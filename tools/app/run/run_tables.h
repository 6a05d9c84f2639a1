// The tables of a run, as its CSV files hold them; the units stand in the keys. Those with a row
// for each frame or pose do not hold them: the run outlives them.
#pragma once

#include "tools/app/result/run_result.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

Table stage_rows(const RunResult& run);
Table frame_rows(const RunResult& run);
Table memory_rows(const RunResult& run);
Table energy_rows(const RunResult& run);
/// Empty where there is no truth, and for replays, whose traces hold no poses of it.
Table error_rows(const RunResult& run);

}  // namespace leviosim::tools
