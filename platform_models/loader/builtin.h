// Files that are part of the program, so that it needs none beside itself. The tables are generated
// from platform_models/chips/*.yaml, isa/*.yaml and code/*.csv when the program is built
// (tools/embed.cmake).
#pragma once

#include <span>

#include "sim/base/builtin_file.h"

namespace leviosim::platform {

/// All sorted by name.
std::span<const base::BuiltinFile> builtin_platforms();
std::span<const base::BuiltinFile> builtin_instruction_sets();
/// Sizes of compiled code (code/*.csv).
std::span<const base::BuiltinFile> builtin_code();

}  // namespace leviosim::platform
