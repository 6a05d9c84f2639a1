// `leviosim sweep`: many points of one plan, by replay where there is a trace, else by live runs.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_sweep_command(CLI::App& app);

}  // namespace leviosim::tools
