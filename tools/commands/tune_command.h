// `leviosim tune`: closed loops over clock and frame rate. Its folder:
//
//   manifest.json   what the batch was made from, and what was chosen
//   runs.csv        a row per point and seed
//   tune.svg        error, missed frames and power over the clock
//   chosen/         the run folder of the lowest clock that is enough, with the first seed, run
//   again
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// @param words  the whole command line, for the manifest; must outlive the command
Command add_tune_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
