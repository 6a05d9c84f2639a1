#include "tools/app/table/table.h"

#include "sim/base/check.h"

namespace leviosim::tools {

void Table::add(std::vector<Cell> cells) {
  check_equal(cells.size(), heads_.size(), "cells in a table row");
  check(!make_rows_, "rows are added to tables that hold them");
  rows_.push_back(std::move(cells));
}

const std::vector<std::vector<Cell>>& Table::rows() const {
  check(!make_rows_, "the table holds its rows");
  return rows_;
}

void Table::each_row(const TakeRow& take) const {
  if (make_rows_) return make_rows_(take);
  for (const std::vector<Cell>& row : rows_) take(row);
}

}  // namespace leviosim::tools
