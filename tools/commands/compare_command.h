// leviosim compare: what differs between runs, and why.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_compare_command(CLI::App& app);

}  // namespace leviosim::tools
