// The cache folder, for files that can be made again.
#pragma once

#include <csignal>
#include <filesystem>

namespace leviosim::tools {

/// ${XDG_CACHE_HOME:-~/.cache}/leviosim, by the XDG base directory specification, which ignores
/// relative paths; need not exist. Without both variables /tmp/leviosim-UID, which is made for the
/// user alone.
/// @throws InputError if it belongs to another user, or could be used by another in /tmp
std::filesystem::path cache_folder();

}  // namespace leviosim::tools
