#include "platform_models/compiled_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <vector>

#include "platform_models/builtin.h"
#include "sim/error.h"

namespace leviosim::platform {
namespace {

constexpr double kLineBytes = 16;
constexpr std::string_view kHeader = "function,after,lines";

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(',', begin);
    cells.push_back(line.substr(begin, end - begin));
    if (end == std::string_view::npos) return cells;
    begin = end + 1;
  }
}

double lines_in(std::string_view cell, const std::string& where) {
  const std::string text(cell);
  char* end = nullptr;
  const double lines = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(lines >= 0 && lines < 1e6))
    throw InputError(fmt::format(
        "{}: lines is \"{}\": expected a number of 16-byte lines, 0 or more", where, text));
  return lines;
}

}  // namespace

work::CodeMap code_map_from(const std::string& file, std::string_view text) {
  work::CodeMap map;
  std::set<std::pair<std::string_view, std::string_view>> seen;
  bool header = false;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::string where = fmt::format("{}:{}", file, number);
    if (!header) {
      if (line.substr(0, kHeader.size()) != kHeader)
        throw InputError(fmt::format("{}: expected a header that begins with {}", where, kHeader));
      header = true;
      continue;
    }
    const std::vector<std::string_view> cells = split(line);
    if (cells.size() < 3 || cells[0].empty())
      throw InputError(fmt::format("{}: expected a row of {}", where, kHeader));
    if (!seen.insert({cells[0], cells[1]}).second)
      throw InputError(
          fmt::format("{}: {} after \"{}\" is there twice", where, cells[0], cells[1]));
    map.add(cells[0], cells[1],
            static_cast<std::uint32_t>(std::lround(lines_in(cells[2], where) * kLineBytes)));
  }
  return map;
}

const work::CodeMap& compiled_code() {
  static const work::CodeMap map = [] {
    const BuiltinFile& file = builtin_code().front();
    return code_map_from(std::string(file.name) + ".csv", file.text);
  }();
  return map;
}

}  // namespace leviosim::platform
