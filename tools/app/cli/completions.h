// The manual page and the completions for shells, generated from the options that the commands
// declare.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// @param format  "man", "bash", "zsh" or "fish"
/// @throws InputError for others
std::string manual(const CLI::App& app, const std::vector<Command>& commands,
                   const std::string& format);

}  // namespace leviosim::tools
