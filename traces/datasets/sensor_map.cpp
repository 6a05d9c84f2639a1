#include "traces/datasets/sensor_map.h"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/LU>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"

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

std::string_view kind_of(const base::YamlNode& node) {
  if (node.is_mapping()) return "a mapping";
  if (node.is_sequence()) return "a list";
  if (node.is_scalar()) return "a single value";
  return "empty";
}

std::string place_of(const std::filesystem::path& file, int line, const std::string& key) {
  const std::string place = base::at_line(file, static_cast<std::size_t>(line));
  return key.empty() ? place : fmt::format("{}, key '{}'", place, key);
}

base::YamlNode parsed(const std::filesystem::path& file) {
  try {
    return base::parse_yaml(base::read_file(file, base::InputKind::sensor));
  } catch (const base::YamlFault& fault) {
    throw InputError(
        fmt::format("{}: {}", place_of(file, fault.line(), fault.path()), fault.message()));
  }
}

}  // namespace

YamlMap::YamlMap(std::filesystem::path file, std::string prefix, const base::YamlNode& node)
    : file_(std::move(file)),
      prefix_(std::move(prefix)),
      line_(node.line()),
      entries_(node.entries()) {}

YamlMap YamlMap::load(const std::filesystem::path& file) {
  const base::YamlNode root = parsed(file);
  if (!root.is_mapping())
    throw InputError(
        fmt::format("{}: is {}; expected keys and values", file.string(), kind_of(root)));
  return YamlMap(file, "", root);
}

std::string YamlMap::nearest_key(const std::string& key) const {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(3, key.size() / 3 + 1);
  for (const base::YamlEntry& entry : entries_) {
    // A name of another length is at least as far away as the lengths are.
    if (entry.key.size() >= key.size() + best_distance) continue;
    const std::size_t distance = edit_distance(entry.key, key);
    if (distance >= best_distance) continue;
    best = entry.key;
    best_distance = distance;
  }
  return best;
}

const base::YamlEntry* YamlMap::find(const std::string& key) const {
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const base::YamlEntry& e) { return e.key == key; });
  return entry == entries_.end() ? nullptr : &*entry;
}

base::YamlNode YamlMap::require(const std::string& key) const {
  if (const base::YamlEntry* entry = find(key)) return entry->value;
  const std::string nearest = nearest_key(key);
  fail_at(line_, key,
          nearest.empty() ? "is missing" : fmt::format("is missing (there is '{}')", nearest));
}

void YamlMap::fail_at(int line, const std::string& key, std::string_view message) const {
  throw InputError(fmt::format("{}: {}", place_of(file_, line, prefix_ + key), message));
}

void YamlMap::fail(const std::string& key, std::string_view message) const {
  fail_at(require(key).line(), key, message);
}

std::string YamlMap::text(const std::string& key) const {
  const base::YamlNode node = require(key);
  if (!node.is_scalar()) fail(key, fmt::format("is {}; expected a text", kind_of(node)));
  return node.scalar();
}

double YamlMap::number(const std::string& key) const {
  double value = 0;
  const std::string spelled = text(key);
  if (!base::parse_number(spelled, value))
    fail(key, fmt::format("'{}' is not a finite number", spelled));
  return value;
}

double YamlMap::positive(const std::string& key, double least, double most) const {
  const double value = number(key);
  if (value < least || value > most)
    fail(key, fmt::format("is {}; expected a number above 0, from {} to {}", value, least, most));
  return value;
}

double YamlMap::not_negative(const std::string& key, double most) const {
  const double value = number(key);
  if (value < 0 || value > most)
    fail(key, fmt::format("is {}; expected a number not below 0, at most {}", value, most));
  return value;
}

bool YamlMap::flag(const std::string& key, bool by_default) const {
  if (find(key) == nullptr) return by_default;
  const std::string spelled = text(key);
  if (spelled != "true" && spelled != "false")
    fail(key, fmt::format("is '{}'; expected true or false", spelled));
  return spelled == "true";
}

std::vector<double> YamlMap::numbers_of(const base::YamlNode& node, const std::string& key,
                                        std::size_t size, std::string_view meaning) const {
  if (!node.is_sequence())
    fail_at(node.line(), key,
            fmt::format("is {}; expected a list of {} numbers ({})", kind_of(node), size, meaning));
  if (node.size() != size)
    fail_at(node.line(), key,
            fmt::format("has {} entries; expected {} ({})", node.size(), size, meaning));
  std::vector<double> values(size);
  for (std::size_t i = 0; i < size; ++i) {
    const base::YamlNode entry = node[i];
    if (!entry.is_scalar() || !base::parse_number(entry.scalar(), values[i]))
      fail_at(entry.line(), key,
              fmt::format("entry {} ('{}') is not a finite number", i + 1,
                          entry.is_scalar() ? entry.scalar() : std::string(kind_of(entry))));
  }
  return values;
}

std::vector<double> YamlMap::numbers(const std::string& key, std::size_t size,
                                     std::string_view meaning) const {
  return numbers_of(require(key), key, size, meaning);
}

std::vector<double> YamlMap::matrix(const std::string& key, std::size_t rows,
                                    std::size_t columns) const {
  const base::YamlNode node = require(key);
  if (!node.is_sequence() || node.size() != rows)
    fail(key, fmt::format("expected a list of {} rows of {} numbers", rows, columns));
  std::vector<double> values;
  for (const base::YamlNode& row : node.items())
    for (const double value : numbers_of(row, key, columns, "a row")) values.push_back(value);
  return values;
}

YamlMap YamlMap::map(const std::string& key) const {
  const base::YamlNode node = require(key);
  if (!node.is_mapping()) fail(key, fmt::format("is {}; expected keys and values", kind_of(node)));
  return YamlMap(file_, fmt::format("{}{}.", prefix_, key), node);
}

}  // namespace leviosim::traces
