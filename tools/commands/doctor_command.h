// `leviosim doctor`: what this program is and what it finds on this machine.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_doctor_command(CLI::App& app);

}  // namespace leviosim::tools
