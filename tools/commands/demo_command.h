// leviosim demo: both profiles on the synthetic flight, and a what-if, on one screen.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_demo_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
