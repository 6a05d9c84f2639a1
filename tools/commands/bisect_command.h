// leviosim bisect: whether the commit that is checked out meets a budget, as `git bisect run` asks.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_bisect_command(CLI::App& app);

}  // namespace leviosim::tools
