// The command `leviosim benchmark-flights`: its options and its files.
#pragma once

#include "tools/app/cli/command_line.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// `leviosim benchmark-flights` (tools/commands/commands.h).
Command add_benchmark_flights_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
