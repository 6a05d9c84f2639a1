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

/// Whether people see kDiverged in place of this value: a length in metres that no vehicle flies.
bool is_diverged(const Head& head, double value);

template <class Row>
struct Column {
  Head head;
  std::function<Cell(const Row&)> value;
};

template <class Row>
using Columns = std::vector<Column<Row>>;

class Table {
 public:
  using TakeRow = std::function<void(const std::vector<Cell>&)>;

  explicit Table(std::vector<Head> heads) : heads_(std::move(heads)) {}
  /// Of more rows than are held: each is made when it is asked for.
  /// @param make_rows  hands over all of them
  Table(std::vector<Head> heads, std::function<void(const TakeRow&)> make_rows)
      : heads_(std::move(heads)), make_rows_(std::move(make_rows)) {}

  /// One cell per column.
  void add(std::vector<Cell> cells);

  const std::vector<Head>& heads() const { return heads_; }
  /// Of a table whose rows are held.
  const std::vector<std::vector<Cell>>& rows() const;
  /// Of any table.
  void each_row(const TakeRow& take) const;

 private:
  std::vector<Head> heads_;
  std::vector<std::vector<Cell>> rows_;
  std::function<void(const TakeRow&)> make_rows_;
};

template <class Row>
std::vector<Head> heads_of(const Columns<Row>& columns) {
  std::vector<Head> heads;
  for (const Column<Row>& column : columns) heads.push_back(column.head);
  return heads;
}

template <class Row>
std::vector<Cell> cells_of(const Columns<Row>& columns, const Row& row) {
  std::vector<Cell> cells;
  for (const Column<Row>& column : columns) cells.push_back(column.value(row));
  return cells;
}

template <class Row, class Rows>
Table table_of(const Columns<Row>& columns, const Rows& rows) {
  Table table(heads_of(columns));
  for (const Row& row : rows) table.add(cells_of(columns, row));
  return table;
}

/// A table whose rows are not held. @param for_each  calls its argument with each row
template <class Row>
Table long_table_of(Columns<Row> columns,
                    std::function<void(const std::function<void(const Row&)>&)> for_each) {
  std::vector<Head> heads = heads_of(columns);
  return Table(std::move(heads), [columns = std::move(columns),
                                  for_each = std::move(for_each)](const Table::TakeRow& take) {
    for_each([&](const Row& row) { take(cells_of(columns, row)); });
  });
}

}  // namespace leviosim::tools
