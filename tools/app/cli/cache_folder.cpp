#include "tools/app/cli/cache_folder.h"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "sim/base/error.h"
#include "sim/outputs/file_system.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWayOut = "set XDG_CACHE_HOME to a folder of yours";

/// Where others can make folders, too: one that nobody else can read or write.
fs::path private_folder(const fs::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    throw InputError(fmt::format("{}: cannot be created: {}; {}", folder.string(),
                                 outputs::reason(errno), kWayOut));
  const std::optional<struct stat> status = outputs::status_of(folder);
  if (!status || !S_ISDIR(status->st_mode) || status->st_uid != ::geteuid() ||
      (status->st_mode & 077) != 0)
    throw InputError(fmt::format(
        "{}: is not a folder that only you can use, and there is no other place for the cache; {}",
        folder.string(), kWayOut));
  return folder;
}

/// It may be a link, as people move their caches to other disks.
fs::path users_folder(const fs::path& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) == 0 && status.st_uid != ::geteuid())
    throw InputError(fmt::format("{}: belongs to another user; {}", folder.string(), kWayOut));
  return folder;
}

}  // namespace

fs::path cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg == '/')
    return users_folder(fs::path(xdg) / "leviosim");
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return users_folder(fs::path(home) / ".cache/leviosim");
  return private_folder(fs::temp_directory_path() / fmt::format("leviosim-{}", ::geteuid()));
}

}  // namespace leviosim::tools
