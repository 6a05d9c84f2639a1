// The entries of one YAML map with their lines, for strict readers: keys are plain words and none
// occurs twice.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

#include "platform_models/value.h"

namespace leviosim::platform {

/// Entries are not to be assigned to: assignment of a YAML::Node writes into the tree it is part
/// of.
struct YamlEntry {
  std::string key;
  YAML::Node value;
  int line;  ///< of the key, from 1
};

/// The only document of a text. Throws InputError with file and line for faults of syntax.
YAML::Node parse_yaml(const std::string& file, const std::string& text);

/// Entries of a map in the order of the file. Throws InputError if `node` is no map, and for keys
/// that are no single words or occur twice.
/// @param path  of the map, for messages; empty for the root
/// @param line  where the map is, if it has no line of its own (an empty one)
std::vector<YamlEntry> entries_of(const YAML::Node& node, const std::string& file,
                                  const std::string& path, int line);

/// The text of a single value; anything else is a fault at `place`.
std::string scalar(const YAML::Node& node, const Place& place);

/// "a map", "a list", "a single value", "empty".
std::string_view kind_of(const YAML::Node& node);

/// Where a key is: "gap9.yaml:12: cluster.workers".
Place place_of(const std::string& file, int line, const std::string& path);

/// "cluster" and "workers" → "cluster.workers"; the root has an empty path.
std::string joined(const std::string& path, const std::string& key);

}  // namespace leviosim::platform
