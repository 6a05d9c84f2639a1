// The screen that the program's name alone prints: its commands, and where to begin.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// At most kScreenLines lines. Commands stand by the titles of their groups, in their order.
std::string welcome(const std::vector<Command>& commands);

}  // namespace leviosim::tools
