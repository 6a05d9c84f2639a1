#include "tools/batch/run_cache.h"

#include <fmt/core.h>

#include "sim/base/input_file.h"
#include "sim/error.h"
#include "tools/cli/cache_folder.h"
#include "traces/atomic_file.h"

namespace leviosim::tools {

namespace fs = std::filesystem;

fs::path default_run_cache() { return cache_folder() / "runs"; }

/// Folders of a few files each, also after a million runs.
fs::path RunCache::file_of(const std::string& key) const {
  return folder_ / key.substr(0, 2) / (key + ".json");
}

std::optional<std::string> RunCache::find_text(const std::string& key) const {
  const fs::path file = file_of(key);
  if (!base::is_file(file)) return std::nullopt;
  return base::read_file(file, base::InputKind::cached_result);
}

void RunCache::store_text(const std::string& key, const std::string& text) const {
  const fs::path file = file_of(key);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw InputError(
        fmt::format("{}: cannot be created: {}", file.parent_path().string(), error.message()));
  traces::write_file_atomically(file, text);
}

std::optional<RunOutcome> RunCache::find(const std::string& key) const {
  const std::optional<std::string> text = find_text(key);
  return text ? parse_outcome(*text) : std::nullopt;
}

void RunCache::store(const std::string& key, const RunOutcome& outcome) const {
  store_text(key, to_text(outcome));
}

}  // namespace leviosim::tools
