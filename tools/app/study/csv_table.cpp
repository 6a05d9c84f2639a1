#include "tools/app/study/csv_table.h"

#include <algorithm>

#include "sim/base/check.h"

namespace leviosim::tools {

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    if (cell.find_first_of(",\"\n\r") == std::string::npos) {
      line += cell;
      continue;
    }
    line += '"';
    for (const char c : cell) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + '\n';
}

std::string csv_text(const std::vector<CsvRow>& rows) {
  const auto line = [](const CsvRow& row, std::string Cell::*part) {
    std::vector<std::string> cells;
    for (const Cell& cell : row) cells.push_back(cell.*part);
    return csv_line(cells);
  };
  std::string names;
  std::string text;
  for (const CsvRow& row : rows) {
    if (names.empty()) names = line(row, &Cell::name);
    check(line(row, &Cell::name) == names, "all rows have the same columns");
    text += line(row, &Cell::text);
  }
  return names + text;
}

std::string plain_cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return c == ',' || c == '"' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string decimals(std::optional<double> value, int count, const char* otherwise) {
  return value ? fmt::format("{:.{}f}", *value, count) : otherwise;
}

}  // namespace leviosim::tools
