// A work trace whose sections are not compressed, for who compresses it as a whole: interactive
// pages hold it so. Only their engine reads it (tools/wasm/plain_sections.cpp). The work that
// compilers made for other instruction sets than that of the page's chip is left out: it is a
// sixth.
#pragma once

#include <optional>
#include <string>

#include "traces/work_traces/work_trace.h"

namespace leviosim::traces {

/// @param code  whose compiled work is kept; of all if absent
/// @throws InputError as unpacked() and the readers of frames
std::string plain_file(const WorkTrace& trace, std::optional<work::CompiledFor> code);

}  // namespace leviosim::traces
