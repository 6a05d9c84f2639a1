// Tables for people: aligned text for terminals, and Markdown. Columns without a title are left
// out, numbers are in the unit of their column.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/screen.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

/// Titles, a rule, and the rows; every line ends in a line break. Columns that do not fit are
/// left out: those of the highest rank first, of equal ones the last, never the first column; the
/// titles then end in "…". Before that, columns of long text, which are aligned to the left, are
/// cut.
std::string terminal_text(const Table& table, int width = table_width());

/// What people see of it: the titles, then the rows.
std::vector<std::vector<std::string>> shown_cells(const Table& table);

/// A table for Markdown files; cells as markdown_text().
std::string markdown_table(const Table& table);

/// A text of which no character means something to Markdown or HTML: it makes no tags, links, lists
/// or headings, and mentions nobody.
std::string markdown_text(const std::string& raw);

}  // namespace leviosim::tools
