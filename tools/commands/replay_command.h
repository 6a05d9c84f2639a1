// `leviosim replay`: a recorded run on another chip.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// @param words  the whole command line, for the manifest; must outlive the command
Command add_replay_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
