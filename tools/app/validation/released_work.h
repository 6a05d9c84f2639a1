// How a run is set up that is compared with the paper.
#pragma once

#include "tools/app/run/run_options.h"

namespace leviosim::tools {

/// The paper's figures are of the released program, which does some things that cost accuracy
/// (workload/PARAMETERS.md#defects-of-the-release). So does levio in such a run, unless the options
/// say otherwise.
RunOptions as_released(RunOptions options);

}  // namespace leviosim::tools
