// Text as lines.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace leviosim::tests {

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The lines of a list or a set as a text, each with its end.
template <class Lines>
std::string joined(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace leviosim::tests
