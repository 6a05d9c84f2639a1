#include "tools/app/study/outcome.h"

#include <fmt/core.h>

#include "sim/base/error.h"
#include "sim/base/sha256.h"
#include "sim/outputs/file_system.h"
#include "tools/app/cli/cache_folder.h"
#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFormat = "leviosim outcome 1";

}  // namespace

std::string to_text(const Outcome& outcome) {
  Json json;
  json["format"] = kFormat;
  json["failure"] = outcome.failure;
  json["protocol"] = outcome.protocol;
  json["figures"] = Json::array();
  for (const Figure& f : outcome.figures)
    json["figures"].push_back(Json::array({f.name, f.unit, f.description, f.value}));
  return json_text(json) + '\n';
}

std::optional<Outcome> parse_outcome(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != kFormat) return std::nullopt;
    Outcome outcome{
        json.at("failure").get<std::string>(), {}, json.at("protocol").get<std::string>()};
    for (const Json& f : json.at("figures"))
      outcome.figures.push_back({f.at(0).get<std::string>(), f.at(1).get<std::string>(),
                                 f.at(2).get<std::string>(), f.at(3).get<double>()});
    return outcome;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestFile = 64 << 20;

/// The first line of a file, by which it is known to be what was stored under the key.
std::string header_of(const std::string& key, const std::string& text) {
  return fmt::format("leviosim cache 2 {} {}\n", key, base::sha256_of(text));
}

}  // namespace

fs::path default_outcome_cache() { return cache_folder() / "outcomes"; }

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

std::optional<Outcome> OutcomeCache::find(const std::string& key) const {
  const std::optional<std::string> text = find_text(key);
  return text ? parse_outcome(*text) : std::nullopt;
}

void OutcomeCache::store(const std::string& key, const Outcome& outcome) const {
  if (find_text(key)) return;  // another process was faster
  const std::string text = to_text(outcome);
  const fs::path file = file_of(key);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw InputError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
  outputs::write_file_atomically(file, header_of(key, text) + text);
}

}  // namespace leviosim::tools
