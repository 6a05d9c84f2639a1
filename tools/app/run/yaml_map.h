// Maps of YAML files for strict readers, such as those of budgets and of plans: values by their
// keys, and faults that say where and what is expected.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform_models/loader/yaml_entries.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace leviosim::tools {

/// What `read` returns, with the place in front of its complaints.
template <class Read>
auto read_at(const platform::Place& place, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    place.fail(error.what());
  }
}

class YamlMap {
 public:
  using Entry = platform::YamlEntry;

  /// @param path  of the map, for messages; empty for the root
  /// @throws InputError if `node` is no map
  YamlMap(const platform::YamlNode& node, std::string file, std::string path)
      : file_(std::move(file)),
        path_(std::move(path)),
        entries_(platform::entries_of(node, file_, path_)) {}
  /// The map that an entry is.
  YamlMap below(const Entry& entry) const {
    return {entry.value, file_, platform::joined(path_, entry.key)};
  }

  /// In the order of the file.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Null if there is no such key.
  const Entry* find(std::string_view key) const {
    const auto it = std::find_if(entries_.begin(), entries_.end(),
                                 [&](const Entry& entry) { return entry.key == key; });
    return it == entries_.end() ? nullptr : &*it;
  }
  platform::Place place(const Entry& entry) const {
    return platform::place_of(file_, entry.line, platform::joined(path_, entry.key));
  }
  /// @throws InputError for any other key
  void check_keys(const std::vector<std::string>& known) const {
    for (const Entry& entry : entries_)
      if (std::find(known.begin(), known.end(), entry.key) == known.end())
        place(entry).fail(fmt::format("unknown key{}; expected {}",
                                      base::did_you_mean(entry.key, known),
                                      fmt::join(known, ", ")));
  }

  std::string text(const Entry& entry) const { return platform::scalar(entry.value, place(entry)); }
  /// The same into `value`, if there is such a key.
  void read(std::string_view key, std::string& value) const {
    if (const Entry* entry = find(key)) value = text(*entry);
  }
  /// What the list of that key holds; nothing if there is no such key.
  std::vector<platform::YamlNode> items(std::string_view key) const {
    const Entry* entry = find(key);
    if (entry == nullptr) return {};
    if (!entry->value.is_sequence())
      place(*entry).fail(fmt::format("is {}; expected a list", platform::kind_of(entry->value)));
    return entry->value.items();
  }

 private:
  std::string file_;
  std::string path_;
  std::vector<Entry> entries_;
};

}  // namespace leviosim::tools
