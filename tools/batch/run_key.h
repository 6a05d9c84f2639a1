// What a finished run is found again by: a digest of everything that its outcome depends on.
#pragma once

#include <string>
#include <string_view>

#include "tools/batch/run_outcome.h"
#include "tools/run/run_request.h"

namespace leviosim::tools {

/// Digest of the sources that the outcome of a run depends on, taken when they are compiled. Not of
/// the compiler: all give the same bits.
std::string_view estimator_version();

/// @param request  a run, native or on a chip; its folder does not matter
/// @param inputs   digest of what is read from the folder (sequence.h)
/// @returns 64 hexadecimal digits
std::string run_key(const RunRequest& request, const std::string& inputs, const Measure& how);

}  // namespace leviosim::tools
