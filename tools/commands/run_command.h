// `leviosim run`: the workload on a chip, or natively, over recorded or synthetic data.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// @param words  the whole command line, for the manifest; must outlive the command
Command add_run_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
