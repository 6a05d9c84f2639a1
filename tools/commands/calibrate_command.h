// `leviosim calibrate`: fits the code-generation constants of a platform.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_calibrate_command(CLI::App& app);

}  // namespace leviosim::tools
