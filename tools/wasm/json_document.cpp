// Documents in the engine of pages: JSON, which is YAML without its freedoms, so that the engine
// needs no libyaml. The loader of platforms reads the same tree.
#include <nlohmann/json.hpp>

#include <utility>

#include "sim/base/yaml_document.h"

namespace leviosim::base {

class YamlTreeBuilder {
 public:
  YamlNode build(std::string_view text) {
    add(nlohmann::ordered_json::parse(text));
    return YamlNode(std::make_shared<const YamlNode::Tree>(std::move(tree_)), 0);
  }

 private:
  using Kind = YamlNode::Kind;

  std::uint32_t add(const nlohmann::ordered_json& json) {
    const auto index = static_cast<std::uint32_t>(tree_.size());
    tree_.emplace_back();
    YamlNode::Item item;
    if (json.is_object()) {
      item.kind = Kind::mapping;
      for (const auto& [key, value] : json.items()) {
        item.keys.push_back({key, 1});
        item.values.push_back(add(value));
      }
    } else if (json.is_array()) {
      item.kind = Kind::sequence;
      for (const auto& value : json) item.values.push_back(add(value));
    } else if (json.is_string()) {
      item.kind = Kind::scalar;
      item.text = json.get<std::string>();
    }
    tree_[index] = std::move(item);
    return index;
  }

  YamlNode::Tree tree_;
};

YamlNode parse_yaml(std::string_view text) { return YamlTreeBuilder().build(text); }

}  // namespace leviosim::base
