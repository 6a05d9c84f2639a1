// Tables of studies as CSV: what a column is called stands beside what its cell holds.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

namespace leviosim::tools {

struct Cell {
  template <class Value>
  Cell(std::string column, const Value& value)
      : name(std::move(column)), text(fmt::format("{}", value)) {}

  std::string name;  ///< of the column, the same in all rows
  std::string text;
};
using CsvRow = std::vector<Cell>;

/// "a,b\n"; what holds a comma, quote or line break is quoted as RFC 4180 asks for.
std::string csv_line(const std::vector<std::string>& cells);

/// Names and rows. @throws CheckFailure unless all rows have the same columns
std::string csv_text(const std::vector<CsvRow>& rows);

/// Text of others as a cell that needs no quotes: what would end it becomes a blank.
std::string plain_cell(std::string text);

/// A number of so many decimals, or `otherwise` if there is none.
std::string decimals(std::optional<double> value, int count, const char* otherwise = "");

}  // namespace leviosim::tools
