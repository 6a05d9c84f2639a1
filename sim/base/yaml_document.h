// One YAML document as a tree. The text may come from anybody: its size, the depth of nesting and
// the number of values are bounded, and every fault is one message with its line.
// Keys are single words of which none occurs twice in a mapping. Values stay text: what they mean
// is the reader's business; only an empty value, ~ and null are distinguished.
// Left out: anchors and aliases, tags other than YAML's own, more than one document; all of them
// are refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/error.h"

namespace leviosim::base {

constexpr std::size_t kMostYamlBytes = std::size_t{1} << 20;
constexpr std::size_t kMostYamlDepth = 64;
constexpr std::size_t kMostYamlNodes = 100'000;

/// What is wrong with a text, apart from the name of its file.
class YamlFault : public InputError {
 public:
  YamlFault(int line, std::string path, const std::string& message);

  int line() const { return line_; }                 ///< from 1
  const std::string& path() const { return path_; }  ///< of the key; "T_BS.data", or empty
  const std::string& message() const { return message_; }

 private:
  int line_;
  std::string path_;
  std::string message_;
};

struct YamlEntry;

/// A place in the tree. Copies are cheap and keep the tree alive.
class YamlNode {
 public:
  bool is_null() const { return item().kind == Kind::null; }
  bool is_scalar() const { return item().kind == Kind::scalar; }
  bool is_sequence() const { return item().kind == Kind::sequence; }
  bool is_mapping() const { return item().kind == Kind::mapping; }
  int line() const { return item().line; }  ///< from 1

  /// The text of a scalar, without quotes.
  const std::string& scalar() const;
  /// Of a sequence or mapping: how many values it has.
  std::size_t size() const { return item().values.size(); }
  /// Value `i` < size() of a sequence or mapping.
  YamlNode operator[](std::size_t i) const;
  /// The values of a sequence.
  std::vector<YamlNode> items() const;
  /// What a mapping holds, in the order of the file.
  std::vector<YamlEntry> entries() const;

 private:
  friend class YamlTreeBuilder;
  enum class Kind { null, scalar, sequence, mapping };
  struct Key {
    std::string text;
    int line;
  };
  struct Item {
    Kind kind = Kind::null;
    int line = 1;
    std::string text;
    std::vector<Key> keys;              // of a mapping, one for each value
    std::vector<std::uint32_t> values;  // places in the tree
  };
  using Tree = std::vector<Item>;

  YamlNode(std::shared_ptr<const Tree> tree, std::size_t index)
      : tree_(std::move(tree)), index_(index) {}
  const Item& item() const { return (*tree_)[index_]; }

  std::shared_ptr<const Tree> tree_;
  std::size_t index_;
};

struct YamlEntry {
  std::string key;
  YamlNode value;
  int line;  ///< of the key, from 1
};

/// The root of the only document of `text`. Throws YamlFault.
YamlNode parse_yaml(std::string_view text);

}  // namespace leviosim::base
