#include "tools/cli/cache_folder.h"

#include <cstdlib>

namespace leviosim::tools {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg == '/')
    return fs::path(xdg) / "leviosim";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return fs::path(home) / ".cache/leviosim";
  return fs::temp_directory_path() / "leviosim";
}

}  // namespace leviosim::tools
