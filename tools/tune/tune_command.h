// `leviosim tune`: closed loops over clock and frame rate. Its folder:
//
//   manifest.json   what the batch was made from, and what was chosen
//   points.csv      a row per point
//   tune.svg        error, missed frames and power over the clock
//   chosen/         the run folder of the lowest clock that is enough, run again; if there is one
#pragma once

#include "tools/cli/command_line.h"

namespace leviosim::tools {

/// @param words  the whole command line, for the manifest; must outlive the command
Command add_tune_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
