// `leviosim trace info FILE` and `leviosim trace check FILE`: what a work trace holds, and whether
// all of it can be read.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_trace_command(CLI::App& app);

}  // namespace leviosim::tools
