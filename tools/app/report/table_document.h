// CSV tables, as base::CsvTable writes them, as JSON.
#pragma once

#include <functional>
#include <string>

#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {

/// An object for each row, with a member for each column: numbers as such, null for empty cells.
Json rows_of_csv(const std::string& csv);

/// A list of cells for each column instead: {"column": [cells…]}.
/// @param where  of the file, for messages
/// @param wanted  whether a column is taken; all if it is empty
/// @throws InputError for rows of another width than the titles
Json csv_json(const std::string& where, const std::string& text,
              const std::function<bool(const std::string&)>& wanted = {});

/// {"format": "leviosim `what`", "version": 1, the members of `more`, "rows": rows_of_csv(csv)},
/// and a line break.
std::string table_document(const std::string& what, const std::string& csv,
                           const Json& more = Json::object());

}  // namespace leviosim::tools
