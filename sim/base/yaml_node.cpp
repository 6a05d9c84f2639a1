// The tree of a document, whatever it was read from (yaml_document.h).
#include <fmt/core.h>

#include <utility>

#include "sim/base/check.h"
#include "sim/base/yaml_document.h"

namespace leviosim::base {

YamlFault::YamlFault(int line, std::string path, const std::string& message)
    : InputError(path.empty() ? fmt::format("line {}: {}", line, message)
                              : fmt::format("line {}: {}: {}", line, path, message)),
      line_(line),
      path_(std::move(path)),
      message_(message) {}

const std::string& YamlNode::scalar() const {
  check(is_scalar(), "a YAML node is a scalar");
  return item().text;
}

YamlNode YamlNode::operator[](std::size_t i) const {
  check(i < size(), "a YAML node has this value");
  return YamlNode(tree_, item().values[i]);
}

std::vector<YamlNode> YamlNode::items() const {
  check(is_sequence(), "a YAML node is a sequence");
  std::vector<YamlNode> items;
  for (std::size_t i = 0; i < size(); ++i) items.push_back((*this)[i]);
  return items;
}

std::vector<YamlEntry> YamlNode::entries() const {
  check(is_mapping(), "a YAML node is a mapping");
  std::vector<YamlEntry> entries;
  for (std::size_t i = 0; i < size(); ++i)
    entries.push_back({item().keys[i].text, (*this)[i], item().keys[i].line});
  return entries;
}

}  // namespace leviosim::base
