// What a finished run is found again by: a digest of everything that its outcome depends on.
#pragma once

#include <string>
#include <string_view>

#include "tools/app/run/run_request.h"
#include "tools/app/study/batch/run_outcome.h"

namespace leviosim::tools {

/// @param request  a run, native or on a chip; its folder does not matter
/// @param inputs   digest of what is read from the folder (sequence.h)
/// @returns 64 hexadecimal digits
std::string run_key(const RunRequest& request, const std::string& inputs, const Measure& how);

}  // namespace leviosim::tools
