// `leviosim flow`: the optical flow of PX4FLOW on a chip.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_flow_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
