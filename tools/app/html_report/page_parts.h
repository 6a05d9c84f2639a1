// The files of page/, and the chart library with its licence, as part of the program; generated
// when it is built (tools/embed.cmake).
#pragma once

#include <span>

#include "sim/base/builtin_file.h"

namespace leviosim::tools {

/// Sorted by path.
std::span<const base::BuiltinFile> page_parts();

}  // namespace leviosim::tools
