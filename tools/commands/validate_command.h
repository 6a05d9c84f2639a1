// `leviosim validate`: the paper's tables beside those of a run.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// @param words  of the command line, for the manifest; must outlive the command
Command add_validate_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
