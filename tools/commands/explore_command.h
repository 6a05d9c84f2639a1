// `leviosim explore`: the paper's parameter sweep. Its folder:
//
//   manifest.json   what the batch was made from
//   runs.csv        a row per run
//   points.csv      a row per point, profile and sequence: medians and spread
//   best.md         the points of least error
//   scatter.svg     absolute over relative error
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_explore_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
