// The first screen of somebody who types the program's name: what there is, and where to begin.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// At most kScreenLines lines. Commands stand by the titles of their groups, in their order.
std::string welcome(const std::vector<Command>& commands);

}  // namespace leviosim::tools
