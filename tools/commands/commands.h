// The commands of leviosim, one source each: it declares the options, calls what is in tools/app,
// and prints. What a command is for, and which files it leaves, stands at the head of its source;
// commands of studies lie with them (tools/app/study).
#pragma once

#include "tools/app/cli/command_line.h"

/// All of them, in the order of the help: ADD(group, name) for each. Groups: what computes, what
/// asks about it, what guards a project's figures, and what the results rest on.
#define LEVIOSIM_COMMANDS(ADD) \
  ADD(run, demo)               \
  ADD(run, run)                \
  ADD(run, replay)             \
  ADD(run, synth)              \
  ADD(run, flow)               \
  ADD(ask, whatif)             \
  ADD(ask, why)                \
  ADD(ask, tune)               \
  ADD(ask, sweep)              \
  ADD(ask, sensitivity)        \
  ADD(ask, ablate)             \
  ADD(ask, benchmark_flights)  \
  ADD(guard, compare)          \
  ADD(guard, check)            \
  ADD(guard, budget)           \
  ADD(guard, history)          \
  ADD(guard, bisect)           \
  ADD(guard, report)           \
  ADD(trust, validate)         \
  ADD(trust, microbench)       \
  ADD(trust, platforms)        \
  ADD(trust, workload)         \
  ADD(trust, recording)        \
  ADD(trust, eval)             \
  ADD(trust, trajectory)       \
  ADD(trust, trace)            \
  ADD(trust, doctor)

namespace leviosim::tools {

/// Adds a command with its options to the program.
/// @param words  the whole command line, for manifests; must outlive the command
#define LEVIOSIM_DECLARE(group, name) \
  Command add_##name##_command(CLI::App& app, const Arguments& words);
LEVIOSIM_COMMANDS(LEVIOSIM_DECLARE)
#undef LEVIOSIM_DECLARE

}  // namespace leviosim::tools
