// Tables that are written as comma-separated values: each column is described once, with its name,
// and how to read its cell from a record. Text that holds a comma, a quote or a line break is
// quoted as RFC 4180 says. Reading is in csv.h.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/units.h"

namespace leviosim::base {

/// What stands in one cell.
class Cell {
 public:
  Cell() = default;  ///< nothing
  Cell(std::string_view text);
  Cell(const std::string& text) : Cell(std::string_view(text)) {}
  Cell(const char* text) : Cell(std::string_view(text)) {}
  template <std::integral T>
  Cell(T value) : text_(std::to_string(value)) {}
  template <class Tag>
  Cell(Quantity<Tag, std::int64_t> value) : Cell(value.count()) {}

  /// As it stands in the file.
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// With so many decimals; nothing where there is no value.
Cell fixed(std::optional<double> value, int decimals);

/// Cells and the line break.
std::string csv_line(const std::vector<Cell>& cells);

template <class Record>
struct Column {
  std::string name;
  std::function<Cell(const Record&)> of;
};

template <class Record>
class CsvTable {
 public:
  CsvTable() = default;
  CsvTable(std::initializer_list<Column<Record>> columns) : columns_(columns) {}

  void add(std::string name, std::function<Cell(const Record&)> of) {
    columns_.push_back({std::move(name), std::move(of)});
  }

  std::string header() const {
    std::vector<Cell> cells;
    for (const Column<Record>& column : columns_) cells.emplace_back(column.name);
    return csv_line(cells);
  }
  std::string line(const Record& record) const {
    std::vector<Cell> cells;
    for (const Column<Record>& column : columns_) cells.push_back(column.of(record));
    return csv_line(cells);
  }
  template <class Records>
  std::string text(const Records& records) const {
    std::string all = header();
    for (const auto& record : records) all += line(record);
    return all;
  }

 private:
  std::vector<Column<Record>> columns_;
};

}  // namespace leviosim::base
