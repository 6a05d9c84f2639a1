// Other programs that a command runs: builds of leviosim, git, what the user names.
#pragma once

#include <csignal>
#include <string>
#include <vector>

namespace leviosim::tools {

/// Runs a program and waits for it. Its stdout and stderr go where those of leviosim's stderr go.
/// @param quiet  drops its stdout
/// @param words  the program, as a shell would find it, and its arguments
/// @returns its exit status, or 128 and the number of the signal that ended it
/// @throws InputError if it cannot be started, Interrupted
int run_child(const std::vector<std::string>& words, bool quiet = false);

/// What it prints on stdout, without the last line break; empty if it fails or is not there. What
/// it prints on stderr is dropped.
std::string output_of(const std::vector<std::string>& words);

}  // namespace leviosim::tools
