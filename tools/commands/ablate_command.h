// `leviosim ablate`: the paper's table of pipeline configurations, for any sequences and image
// sizes. Its folder:
//
//   manifest.json   what the batch was made from
//   runs.csv        a row per run
//   table.md        the table that is printed
//   table.json      its rows, with more digits
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_ablate_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
