// Strict access to one YAML mapping: every fault is an InputError that names file, line and key.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/yaml_document.h"

namespace leviosim::traces {

class YamlMap {
 public:
  /// Parses a file whose root is a mapping. Throws InputError if it cannot be read or parsed.
  static YamlMap load(const std::filesystem::path& file);

  std::string text(const std::string& key) const;
  /// A finite number.
  double number(const std::string& key) const;
  /// A number above zero, from `least` to `most`.
  double positive(const std::string& key, double least, double most) const;
  /// A number from zero to `most`.
  double not_negative(const std::string& key, double most) const;
  /// true or false; `by_default` if the key is not there.
  bool flag(const std::string& key, bool by_default) const;
  bool has(const std::string& key) const { return find(key) != nullptr; }
  /// A list of exactly `size` finite numbers; `meaning` says what they are.
  std::vector<double> numbers(const std::string& key, std::size_t size,
                              std::string_view meaning) const;
  /// A list of `rows` lists of `columns` finite numbers each, row by row.
  std::vector<double> matrix(const std::string& key, std::size_t rows, std::size_t columns) const;
  YamlMap map(const std::string& key) const;

  /// Throws an InputError about the value of a key: "FILE line N, key 'key': MESSAGE".
  [[noreturn]] void fail(const std::string& key, std::string_view message) const;

 private:
  YamlMap(std::filesystem::path file, std::string prefix, const base::YamlNode& node);
  const base::YamlEntry* find(const std::string& key) const;
  std::vector<double> numbers_of(const base::YamlNode& node, const std::string& key,
                                 std::size_t size, std::string_view meaning) const;
  base::YamlNode require(const std::string& key) const;
  std::string nearest_key(const std::string& key) const;
  [[noreturn]] void fail_at(int line, const std::string& key, std::string_view message) const;

  std::filesystem::path file_;
  std::string prefix_;  // of nested keys, "T_BS."
  int line_;            // where it begins
  std::vector<base::YamlEntry> entries_;
};

}  // namespace leviosim::traces
