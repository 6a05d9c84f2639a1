// CSV files of leviosim as JSON: {"column": [cells…]}, numbers as numbers, empty cells as null.
#pragma once

#include <functional>
#include <string>

#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {

/// Cells may be quoted as RFC 4180 says. @param where  of the file, for messages
/// @param wanted  whether a column is taken; all if it is empty
/// @throws InputError for rows of another width than the titles
Json csv_json(const std::string& where, const std::string& text,
              const std::function<bool(const std::string&)>& wanted = {});

}  // namespace leviosim::tools
