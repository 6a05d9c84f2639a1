// The leviosim program as a function, so that programs with workloads of their own have all its
// commands.
#pragma once

#include <vector>

#include "tools/app/run/workload.h"

namespace leviosim {

/// Adds the workloads and runs the command that the words name. Where no profile is named, the last
/// workload runs, or levio if there is none.
/// @returns the exit status: 0 if done, 1 if a limit that the user set was not met, 2 for bad
/// input, with
///          one message on stderr, 130 and 143 where it was interrupted. Faults of leviosim itself
///          abort.
int main_with(int argc, char** argv, std::vector<Workload> workloads = {});

}  // namespace leviosim
