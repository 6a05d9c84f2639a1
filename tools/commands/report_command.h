// leviosim report: runs as one HTML page, from their folders alone.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_report_command(CLI::App& app);

}  // namespace leviosim::tools
