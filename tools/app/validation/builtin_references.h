// tools/app/validation/published/*.csv as part of the program; generated when it is built
// (tools/embed.cmake).
#pragma once

#include <span>
#include <string_view>

#include "sim/base/builtin_file.h"

namespace leviosim::tools {

/// Sorted by name.
std::span<const base::BuiltinFile> builtin_references();

/// The text of published/NAME.csv, which must be there.
std::string_view reference_text(std::string_view name);

}  // namespace leviosim::tools
