// What of a recorded chip an interactive page moves: for each of its resources the values of a
// slider, and accelerators that built-in chips have on top of it as switches. Names, units and help
// are the schema's.
//
// Left out: whether a value can run, which the engine says where it is asked.
#pragma once

#include <cstdint>

#include "platform_models/loader/platform_file.h"
#include "tools/app/table/json.h"

namespace leviosim::tools {

/// [{"path", "help", "unit", "values": ["64KiB", …] as -p takes them, "recorded": index}, …]
/// and, where the page cannot move it, "fixed": why. @param period_ns  of the camera, whose rate
/// "fps" is the last
Json knobs_json(const platform::Schema& schema, const platform::ResolvedPlatform& chip,
                std::int64_t period_ns);

/// [{"name": "gap9-hamming", "help", "settings": ["cluster.accelerators.hamming.units=1", …]}, …]
Json switches_json(const platform::ResolvedPlatform& chip);

}  // namespace leviosim::tools
