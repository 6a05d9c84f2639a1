// Tables, of which each column is described once: for the terminal, for Markdown, CSV, JSON and
// pages. terminal_table.h and table_files.h render them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/app/table/cell.h"

namespace leviosim::tools {

enum class Align { Left, Right };
inline constexpr auto kLeft = Align::Left;
inline constexpr auto kRight = Align::Right;

/// As many digits as the number has.
inline constexpr int kAllDigits = -1;

/// Description of a column, without its rows. A column without a title is only in files, one
/// without a key only for people.
struct Head {
  std::string title = {};  ///< for people
  Align align = kRight;
  int rank = 0;                    ///< columns of the highest rank are left out first, for width
  int shown = kAllDigits;          ///< decimals for people
  const char* nothing = kNothing;  ///< what people see where there is no value
  std::string key = {};       ///< for files: its name, with the unit in which the value is kept
  int decimals = kAllDigits;  ///< in files
  std::string unit = {};      ///< for people
  double scale = 1;           ///< from the value to that unit
  bool is_banded = false;     ///< in files: two more columns, for the ends of the band
  bool is_setup = false;      ///< on a page: an input of the study; else a result
  bool more_is_better = false;
};

template <class Row>
struct Column {
  Head head;
  std::function<Cell(const Row&)> value;
};

template <class Row>
using Columns = std::vector<Column<Row>>;

class Table {
 public:
  explicit Table(std::vector<Head> heads) : heads_(std::move(heads)) {}

  /// One cell per column.
  void add(std::vector<Cell> cells);

  const std::vector<Head>& heads() const { return heads_; }
  const std::vector<std::vector<Cell>>& rows() const { return rows_; }

 private:
  std::vector<Head> heads_;
  std::vector<std::vector<Cell>> rows_;
};

template <class Row, class Rows>
Table table_of(const Columns<Row>& columns, const Rows& rows) {
  std::vector<Head> heads;
  for (const Column<Row>& column : columns) heads.push_back(column.head);
  Table table(std::move(heads));
  for (const Row& row : rows) {
    std::vector<Cell> cells;
    for (const Column<Row>& column : columns) cells.push_back(column.value(row));
    table.add(std::move(cells));
  }
  return table;
}

}  // namespace leviosim::tools
