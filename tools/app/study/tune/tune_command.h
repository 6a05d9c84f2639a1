// The command `leviosim tune`: its options, its files, and the run that it recommends.
#pragma once

#include "tools/app/cli/command_line.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// `leviosim tune` (tools/commands/commands.h).
Command add_tune_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
