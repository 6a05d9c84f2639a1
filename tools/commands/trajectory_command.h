// `leviosim trajectory`: a trajectory in the format of other programs, on stdout.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_trajectory_command(CLI::App& app);

}  // namespace leviosim::tools
