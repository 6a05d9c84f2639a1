#include "sim/base/csv_table.h"

#include <fmt/format.h>

namespace leviosim::base {

Cell::Cell(std::string_view text) : text_(text) {
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) return;
  text_ = '"';
  for (const char c : text) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
  text_ += '"';
}

Cell fixed(std::optional<double> value, int decimals) {
  return value ? Cell(fmt::format("{:.{}f}", *value, decimals)) : Cell();
}

std::string csv_line(const std::vector<Cell>& cells) {
  std::string line;
  for (const Cell& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    line += cell.text();
  }
  return line + '\n';
}

}  // namespace leviosim::base
