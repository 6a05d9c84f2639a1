// `leviosim platforms`: which chips there are, and what is known about one.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_platforms_command(CLI::App& app);

}  // namespace leviosim::tools
