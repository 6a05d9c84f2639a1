// A CSV table as a JSON document, for commands whose results are rows.
#pragma once

#include <string>

#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {

/// An object for each row, with a member for each column: numbers as such, null for empty cells.
/// @param csv  as base::CsvTable writes it: a header, quotes where they are needed
Json rows_of_csv(const std::string& csv);

/// {"format": "leviosim `what`", "version": 1, the members of `more`, "rows": rows_of_csv(csv)}, and
/// a line break.
std::string table_document(const std::string& what, const std::string& csv,
                           const Json& more = Json::object());

}  // namespace leviosim::tools
