// leviosim history: runs over time, by commit, in a file.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_history_command(CLI::App& app);

}  // namespace leviosim::tools
