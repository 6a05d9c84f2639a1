// The text about energy that `leviosim run` prints. Pure functions of the result; empty where the
// platform has no energy figures. Columns that do not fit into the width are left out.
#pragma once

#include <string>

#include "tools/app/result/run_result.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {

/// Energy of a call and power while it runs, with bands, for every stage and the idle time; energy
/// per frame, mean power, and power while the front end runs.
std::string energy_table(const RunResult& run, int width = table_width());

/// Mean power of the stages by domain of the chip.
std::string power_table(const RunResult& run, int width = table_width());

/// Energy per frame and mean power at the ends of the supply's line, with the same cycles.
std::string operating_point_table(const RunResult& run, int width = table_width());

}  // namespace leviosim::tools
