// Where leviosim keeps what it can make again.
#pragma once

#include <filesystem>

namespace leviosim::tools {

/// ${XDG_CACHE_HOME:-~/.cache}/leviosim, by the XDG base directory specification, which ignores
/// relative paths; need not exist.
std::filesystem::path cache_folder();

}  // namespace leviosim::tools
