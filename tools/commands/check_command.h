// leviosim check: holds a run against a budget.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_check_command(CLI::App& app);

}  // namespace leviosim::tools
