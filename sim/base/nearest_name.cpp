#include "sim/base/nearest_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace leviosim::base {
namespace {

// Names in platform files are short. Longer input is no misspelling of one of them, and need not
// be compared in full.
constexpr std::size_t kLongestName = 100;

/// Length of the longest common subsequence.
std::size_t common(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1, 0);
  for (const char c : a) {
    std::size_t diagonal = 0;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = c == b[j] ? diagonal + 1 : std::max(above, row[j]);
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

std::string nearest(std::string_view typed, const std::vector<std::string>& valid) {
  typed = typed.substr(0, kLongestName);
  if (typed.empty()) return {};
  std::string best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const std::string& name : valid) {
    const std::size_t shared = common(typed, name);
    const std::size_t edits = typed.size() + name.size() - 2 * shared;
    if (edits >= fewest || 2 * shared < typed.size()) continue;
    fewest = edits;
    best = name;
  }
  return best;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& valid) {
  const std::string name = nearest(typed, valid);
  return name.empty() ? std::string() : fmt::format("; did you mean '{}'?", name);
}

}  // namespace leviosim::base
