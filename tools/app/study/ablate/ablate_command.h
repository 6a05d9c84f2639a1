// The command `leviosim ablate`: its options, and what it leaves.
#pragma once

#include "tools/app/cli/command_line.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// `leviosim ablate` (tools/commands/commands.h).
Command add_ablate_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
