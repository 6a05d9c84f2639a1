// The table and the file of `leviosim sensitivity`.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/study/sensitivity/sensitivity.h"

namespace leviosim::tools {

/// The largest effects first; numbers without any effect are only named.
/// As parts of a screen.
std::vector<std::string> sensitivity_tables(const Sensitivity& sensitivity, int workers);

/// A row per number with both ends of its range, times in ms, changes in per cent.
Table sensitivity_rows(const Sensitivity& sensitivity);

/// `leviosim sensitivity` (tools/commands/commands.h).
Command add_sensitivity_command(CLI::App& app, const Arguments& words);

}  // namespace leviosim::tools
