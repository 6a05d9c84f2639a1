// A file of sections (section_file.h) whose contents are not compressed, for who compresses it as a
// whole: interactive pages hold work traces so. Only their engine reads it
// (tools/wasm/plain_sections.cpp).
#pragma once

#include <string>
#include <string_view>

#include "traces/work_traces/section_file.h"

namespace leviosim::traces {

/// @param file  its name, for messages
/// @throws InputError as sections_of() and unpacked()
std::string plain_file(const FileKind& kind, const std::string& file, std::string_view bytes,
                       MemoryBudget budget);

}  // namespace leviosim::traces
