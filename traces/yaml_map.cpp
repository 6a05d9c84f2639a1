#include "traces/yaml_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "sim/error.h"
#include "traces/csv.h"

namespace leviosim::traces {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string_view kind_of(const YAML::Node& node) {
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return "a list";
  if (node.IsScalar()) return "a single value";
  return "empty";
}

}  // namespace

YamlMap::YamlMap(std::filesystem::path file, std::string prefix, YAML::Node node)
    : file_(std::move(file)), prefix_(std::move(prefix)), node_(std::move(node)) {}

YamlMap YamlMap::load(const std::filesystem::path& file) {
  try {
    const YAML::Node root = YAML::Load(read_text_file(file));
    if (!root.IsMap())
      throw InputError(
          fmt::format("{}: is {}; expected keys and values", file.string(), kind_of(root)));
    return YamlMap(file, "", root);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}: is no valid YAML: {}",
                                 at_line(file, static_cast<std::size_t>(e.mark.line + 1)), e.msg));
  }
}

std::string YamlMap::nearest_key(const std::string& key) const {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(3, key.size() / 3 + 1);
  for (const auto& entry : node_) {
    const std::string name = entry.first.Scalar();
    const std::size_t distance = edit_distance(name, key);
    if (distance >= best_distance) continue;
    best = name;
    best_distance = distance;
  }
  return best;
}

YAML::Node YamlMap::require(const std::string& key) const {
  const YAML::Node node = node_[key];
  if (node.IsDefined()) return node;
  const std::string nearest = nearest_key(key);
  fail_at(node_, key,
          nearest.empty() ? "is missing" : fmt::format("is missing (there is '{}')", nearest));
}

void YamlMap::fail_at(const YAML::Node& node, const std::string& key,
                      std::string_view message) const {
  const auto line = static_cast<std::size_t>(std::max(0, node.Mark().line) + 1);
  throw InputError(fmt::format("{}, key '{}{}': {}", at_line(file_, line), prefix_, key, message));
}

void YamlMap::fail(const std::string& key, std::string_view message) const {
  fail_at(require(key), key, message);
}

std::string YamlMap::text(const std::string& key) const {
  const YAML::Node node = require(key);
  if (!node.IsScalar()) fail_at(node, key, fmt::format("is {}; expected a text", kind_of(node)));
  return node.Scalar();
}

double YamlMap::number(const std::string& key) const {
  double value = 0;
  const std::string spelled = text(key);
  if (!parse_number(spelled, value)) fail(key, fmt::format("'{}' is not a finite number", spelled));
  return value;
}

double YamlMap::positive(const std::string& key) const {
  const double value = number(key);
  if (value <= 0) fail(key, fmt::format("is {}; expected a number above 0", value));
  return value;
}

double YamlMap::not_negative(const std::string& key) const {
  const double value = number(key);
  if (value < 0) fail(key, fmt::format("is {}; expected a number not below 0", value));
  return value;
}

bool YamlMap::flag(const std::string& key, bool by_default) const {
  if (!node_[key].IsDefined()) return by_default;
  const std::string spelled = text(key);
  if (spelled != "true" && spelled != "false")
    fail(key, fmt::format("is '{}'; expected true or false", spelled));
  return spelled == "true";
}

std::vector<double> YamlMap::numbers(const std::string& key, std::size_t size,
                                     std::string_view meaning) const {
  const YAML::Node node = require(key);
  if (!node.IsSequence())
    fail_at(node, key,
            fmt::format("is {}; expected a list of {} numbers ({})", kind_of(node), size, meaning));
  if (node.size() != size)
    fail_at(node, key, fmt::format("has {} entries; expected {} ({})", node.size(), size, meaning));
  std::vector<double> values(size);
  for (std::size_t i = 0; i < size; ++i) {
    const YAML::Node entry = node[i];
    if (!entry.IsScalar() || !parse_number(entry.Scalar(), values[i]))
      fail_at(entry, key,
              fmt::format("entry {} ('{}') is not a finite number", i + 1,
                          entry.IsScalar() ? entry.Scalar() : std::string(kind_of(entry))));
  }
  return values;
}

YamlMap YamlMap::map(const std::string& key) const {
  const YAML::Node node = require(key);
  if (!node.IsMap())
    fail_at(node, key, fmt::format("is {}; expected keys and values", kind_of(node)));
  return YamlMap(file_, fmt::format("{}{}.", prefix_, key), node);
}

}  // namespace leviosim::traces
