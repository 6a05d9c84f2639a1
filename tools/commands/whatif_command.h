// leviosim whatif: a recorded run on other chips, a row a variant; without a change, advice.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_whatif_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
