// `leviosim benchmark-flights`: how accurate the workload is on flights that chose nothing. Its
// folder:
//
//   manifest.json   what the benchmark was made from
//   runs.csv        a row per run
//   pieces.csv      a row per profile and piece, over the seeds
//   table.md        the table that is printed
//   table.json      its rows and the pieces, with more digits
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

Command add_benchmark_flights_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
