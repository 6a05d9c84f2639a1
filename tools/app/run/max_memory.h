// --max-memory SIZE: the host memory that a work trace may take.
#pragma once

#include <string>

#include "sim/base/units.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// Declares the option. @param text  its value; empty if it is not given
void add_memory_option(CLI::App& command, std::string& text);

/// What the option allows: "512 MiB", "2GiB"; by default traces::kTraceMemory.
/// @throws InputError for what is no size or out of range
Bytes trace_memory(const std::string& text);

}  // namespace leviosim::tools
