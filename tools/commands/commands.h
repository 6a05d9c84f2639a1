// The commands of leviosim, one source each: it declares the options, calls what is in tools/app,
// and prints. What a command is for, and which files it leaves, stands at the head of its source;
// commands of studies lie with them (tools/app/study).
#pragma once

#include "tools/app/cli/command_line.h"

/// All of them, in the order of the help: ADD(name) for each.
#define LEVIOSIM_COMMANDS(ADD) \
  ADD(demo)              \
  ADD(run)               \
  ADD(synth)             \
  ADD(doctor)            \
  ADD(platforms)         \
  ADD(workload)          \
  ADD(eval)              \
  ADD(image_statistics)  \
  ADD(trajectory)        \
  ADD(ablate)            \
  ADD(explore)           \
  ADD(benchmark_flights) \
  ADD(validate)          \
  ADD(calibrate)         \
  ADD(sensitivity)       \
  ADD(microbench)        \
  ADD(replay)            \
  ADD(trace)             \
  ADD(whatif)            \
  ADD(why)               \
  ADD(tune)              \
  ADD(sweep)             \
  ADD(flow)              \
  ADD(compare)           \
  ADD(check)             \
  ADD(budget)            \
  ADD(history)           \
  ADD(bisect)            \
  ADD(report)

namespace leviosim::tools {

/// Adds a command with its options to the program.
/// @param words  the whole command line, for manifests; must outlive the command
#define LEVIOSIM_DECLARE(name) Command add_##name##_command(CLI::App& app, const Words& words);
LEVIOSIM_COMMANDS(LEVIOSIM_DECLARE)
#undef LEVIOSIM_DECLARE

}  // namespace leviosim::tools
