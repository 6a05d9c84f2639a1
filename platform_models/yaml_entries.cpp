#include "platform_models/yaml_entries.h"

#include <fmt/format.h>

#include <map>

#include "sim/error.h"

namespace leviosim::platform {
namespace {

int line_or(const YAML::Node& node, int otherwise) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? otherwise : mark.line + 1;
}

}  // namespace

YAML::Node parse_yaml(const std::string& file, const std::string& text) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}: not valid YAML: {}", file,
                                 e.mark.is_null() ? 1 : e.mark.line + 1, e.msg));
  }
  if (documents.empty()) throw InputError(fmt::format("{}:1: the file is empty", file));
  if (documents.size() > 1)
    throw InputError(fmt::format("{}:{}: a second document begins; expected one", file,
                                 line_or(documents[1], 1)));
  return documents.front();
}

std::vector<YamlEntry> entries_of(const YAML::Node& node, const std::string& file,
                                  const std::string& path, int line) {
  if (!node.IsMap())
    place_of(file, line_or(node, line), path)
        .fail(fmt::format("is {}; expected a map of keys and values", kind_of(node)));
  std::vector<YamlEntry> entries;
  std::map<std::string, int> first_lines;
  for (const auto& entry : node) {
    const int key_line = line_or(entry.first, line);
    if (!entry.first.IsScalar())
      place_of(file, key_line, path)
          .fail(fmt::format("a key is {}; expected a word", kind_of(entry.first)));
    const std::string key = entry.first.Scalar();
    const auto [first, is_new] = first_lines.emplace(key, key_line);
    if (!is_new)
      place_of(file, key_line, joined(path, key))
          .fail(fmt::format("duplicate key, first given on line {}", first->second));
    entries.push_back({key, entry.second, key_line});
  }
  return entries;
}

std::string scalar(const YAML::Node& node, const Place& place) {
  if (!node.IsScalar()) place.fail(fmt::format("is {}; expected a single value", kind_of(node)));
  return node.Scalar();
}

std::string_view kind_of(const YAML::Node& node) {
  if (node.IsMap()) return "a map";
  if (node.IsSequence()) return "a list";
  if (node.IsScalar()) return "a single value";
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
