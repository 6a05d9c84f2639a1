// Values of the keys of a plan, each text once per key, so that a point of a million is a few small
// numbers.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace leviosim::tools {

/// Number of a value among those of its key.
using ValueId = std::uint32_t;
inline constexpr ValueId kUnset = UINT32_MAX;

class ValuePool {
 public:
  /// @param keys  how many there are
  explicit ValuePool(std::size_t keys);
  ValuePool(const ValuePool&) = delete;
  ValuePool& operator=(const ValuePool&) = delete;

  /// The same number for the same text.
  ValueId add(std::size_t key, const std::string& text);

  const std::string& text(std::size_t key, ValueId id) const { return tables_[key].texts[id]; }
  std::size_t size(std::size_t key) const { return tables_[key].texts.size(); }

 private:
  struct Hash {
    using is_transparent = void;
    const std::vector<std::string>* texts;
    std::size_t operator()(std::string_view text) const {
      return std::hash<std::string_view>()(text);
    }
    std::size_t operator()(ValueId id) const { return (*this)((*texts)[id]); }
  };
  struct Equal {
    using is_transparent = void;
    const std::vector<std::string>* texts;
    std::string_view of(std::string_view text) const { return text; }
    std::string_view of(ValueId id) const { return (*texts)[id]; }
    template <class A, class B>
    bool operator()(const A& a, const B& b) const {
      return of(a) == of(b);
    }
  };
  struct Table {
    std::vector<std::string> texts;
    std::unordered_set<ValueId, Hash, Equal> ids{0, Hash{&texts}, Equal{&texts}};
  };
  std::deque<Table> tables_;  // which stay where they are
};

}  // namespace leviosim::tools
