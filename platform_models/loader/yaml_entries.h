// The entries of one YAML map with their lines, for strict readers, and messages that say where a
// key is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/value.h"
#include "sim/base/yaml_document.h"

namespace leviosim::platform {

using base::YamlEntry;
using base::YamlNode;

/// The only document of a text. Throws InputError with file, line and key.
YamlNode parse_yaml(const std::string& file, const std::string& text);

/// Entries of a map in the order of the file. Throws InputError if `node` is no map.
/// @param path  of the map, for messages; empty for the root
std::vector<YamlEntry> entries_of(const YamlNode& node, const std::string& file,
                                  const std::string& path);

/// The text of a single value; anything else is a fault at `place`.
std::string scalar(const YamlNode& node, const Place& place);

/// "a map", "a list", "a single value", "empty".
std::string_view kind_of(const YamlNode& node);

/// Where a key is: "gap9.yaml:12: cluster.workers".
Place place_of(const std::string& file, int line, const std::string& path);

/// "cluster" and "workers" → "cluster.workers"; the root has an empty path.
std::string joined(const std::string& path, const std::string& key);

}  // namespace leviosim::platform
