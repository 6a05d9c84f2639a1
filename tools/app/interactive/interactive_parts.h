// The scripts of interactive pages as part of the program, and "engine", the replay engine as
// WebAssembly in gzip, where the build made it (option LEVIOSIM_WASM).
#pragma once

#include <span>

#include "sim/base/builtin_file.h"

namespace leviosim::tools {

std::span<const base::BuiltinFile> interactive_parts();

}  // namespace leviosim::tools
