// leviosim budget: makes baselines and first budgets.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_budget_command(CLI::App& app);

}  // namespace leviosim::tools
