// `leviosim eval`: how far an estimated trajectory lies from the ground truth.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_eval_command(CLI::App& app);

}  // namespace leviosim::tools
