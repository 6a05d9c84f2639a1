#include "platform_models/loader/yaml_entries.h"

#include <fmt/format.h>

namespace leviosim::platform {

YamlNode parse_yaml(const std::string& file, const std::string& text) {
  try {
    return base::parse_yaml(text);
  } catch (const base::YamlFault& fault) {
    place_of(file, fault.line(), fault.path()).fail(fault.message());
  }
}

std::vector<YamlEntry> entries_of(const YamlNode& node, const std::string& file,
                                  const std::string& path) {
  if (!node.is_mapping())
    place_of(file, node.line(), path)
        .fail(fmt::format("is {}; expected a map of keys and values", kind_of(node)));
  return node.entries();
}

std::string scalar(const YamlNode& node, const Place& place) {
  if (!node.is_scalar()) place.fail(fmt::format("is {}; expected a single value", kind_of(node)));
  return node.scalar();
}

std::string_view kind_of(const YamlNode& node) {
  if (node.is_mapping()) return "a map";
  if (node.is_sequence()) return "a list";
  if (node.is_scalar()) return "a single value";
  return "empty";
}

Place place_of(const std::string& file, int line, const std::string& path) {
  return {path.empty() ? fmt::format("{}:{}", file, line)
                       : fmt::format("{}:{}: {}", file, line, path)};
}

std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

}  // namespace leviosim::platform
