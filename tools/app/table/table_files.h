// Tables for programs: CSV and JSON, of the columns that have a key. Values are in the unit that
// the key names; text that holds a comma, a quote or a line break is quoted as RFC 4180 says. A
// figure with a band is three columns: KEY, KEY_low, KEY_high.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/table/json.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

std::string csv_text(const Table& table);
/// The same by pieces.
void write_csv(const Table& table, const std::function<void(std::string_view)>& sink);

/// One line of CSV, for tables that are too large to be held.
std::string csv_line(const std::vector<std::string>& cells);

/// What csv() writes, with keys alone. @param where  of the file, for messages
/// @throws InputError for rows of another width than the titles
Table read_csv(const std::string& where, const std::string& text);

/// An object for each row, with a member for each column: numbers as such, null for nothing.
Json rows_json(const Table& table);

/// A list of cells for each column instead: {"column": [cells…]}.
/// @param wanted  whether a column is taken; all if it is empty
Json columns_json(const Table& table, const std::function<bool(const std::string&)>& wanted = {});

/// {"format": "leviosim `what`", "version": 1, the members of `more`, "rows": rows_json(table)},
/// and a line break.
std::string table_document(const std::string& what, const Table& table,
                           const Json& more = Json::object());

}  // namespace leviosim::tools
