// leviosim microbench: small programs on a chip beside what is known of the real one.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_microbench_command(CLI::App& app);

}  // namespace leviosim::tools
