// `leviosim synth`: the synthetic flight as an ASL folder.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_synth_command(CLI::App& app);

}  // namespace leviosim::tools
