// `leviosim workload`: profiles of the workload, and its parameters with unit, range and value.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_workload_command(CLI::App& app);

}  // namespace leviosim::tools
