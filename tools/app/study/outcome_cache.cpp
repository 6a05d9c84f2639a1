#include "tools/app/study/outcome_cache.h"

#include <fmt/core.h>

#include "sim/base/error.h"
#include "sim/base/sha256.h"
#include "sim/outputs/file_system.h"
#include "tools/app/record/json_reader.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestFile = 64 << 20;

/// The first line of a file, by which it is known to be what was stored under the key.
std::string header_of(const std::string& key, const std::string& text) {
  return fmt::format("leviosim cache 3 {} {}\n", key, base::sha256_of(text));
}

}  // namespace

/// Folders of a few files each, also after a million runs.
fs::path OutcomeCache::file_of(const std::string& key) const {
  return folder_ / key.substr(0, 2) / (key + ".json");
}

std::optional<std::string> OutcomeCache::find_text(const std::string& key) const {
  const std::optional<std::string> bytes = outputs::try_read_file(file_of(key), kLargestFile);
  if (!bytes) return std::nullopt;
  const std::size_t end = bytes->find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string text = bytes->substr(end + 1);
  if (bytes->compare(0, end + 1, header_of(key, text)) != 0) return std::nullopt;
  return text;
}

std::optional<RunRecord> OutcomeCache::find(const std::string& key) const {
  const std::optional<std::string> text = find_text(key);
  const std::optional<Json> json = text ? try_read_json(*text) : std::nullopt;
  if (!json) return std::nullopt;
  try {
    return record_of_json("", *json, Level::figures);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void OutcomeCache::store(const std::string& key, const RunRecord& outcome) const {
  if (find_text(key)) return;  // another process was faster
  const std::string text = json_text(record_json(outcome)) + '\n';
  const fs::path file = file_of(key);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw InputError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
  outputs::write_file_atomically(file, header_of(key, text) + text);
}

}  // namespace leviosim::tools
