// `leviosim sensitivity`: which uncertain numbers of a platform matter.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_sensitivity_command(CLI::App& app);

}  // namespace leviosim::tools
