// The command `leviosim sweep`, its report and its page.
#pragma once

#include "tools/app/cli/command_line.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// `leviosim sweep` (tools/commands/commands.h).
Command add_sweep_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
