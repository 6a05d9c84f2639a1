#include "tools/app/table/table.h"

#include "sim/base/check.h"

namespace leviosim::tools {

void Table::add(std::vector<Cell> cells) {
  check_equal(cells.size(), heads_.size(), "cells in a table row");
  rows_.push_back(std::move(cells));
}

}  // namespace leviosim::tools
