// Text: its parts, names that were mistyped, and text from outside made fit to print.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace leviosim::base {

/// What stands between separators, one part more than there are separators; empty parts too.
inline std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

}  // namespace leviosim::base
