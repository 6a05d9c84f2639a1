// tools/app/validation/published/*.csv as part of the program; generated when it is built
// (tools/embed.cmake).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/builtin_file.h"
#include "sim/base/csv.h"

namespace leviosim::tools {

/// Sorted by name.
std::span<const base::BuiltinFile> builtin_references();

/// The text of published/NAME.csv, which must be there.
std::string_view reference_text(std::string_view name);

/// Calls `visit` for each row of such a file below its first, which must be these titles.
/// @throws InputError with file, line and column, and what `visit` throws
void for_each_row(const std::string& file, std::string_view text,
                  const std::vector<std::string>& titles,
                  const std::function<void(const base::CsvRow&)>& visit);

}  // namespace leviosim::tools
