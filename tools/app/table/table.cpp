#include "tools/app/table/table.h"

#include <cmath>

#include "sim/base/check.h"

namespace leviosim::tools {

bool is_diverged(const Head& head, double value) {
  const bool in_metres = head.unit == "m" || (head.unit.empty() && head.key.ends_with("_m"));
  return in_metres && !(std::abs(value * head.scale) < kDiverged_m);
}

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
