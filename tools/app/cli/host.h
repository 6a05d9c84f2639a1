// What commands need of the host: interrupts that are held back, a stack, other programs, the
// folder of caches.
//
// Ctrl-C and termination requests are handled between two steps of work instead of in the middle of
// one, so that staged output is removed on the way out (sim/base/interruption.h).
#pragma once

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/base/interruption.h"

namespace leviosim::tools {

/// Holds back the signals of interrupting_signals() during its life, in this thread and in threads
/// started meanwhile. What has arrived takes its usual effect at the end: the process dies of the
/// signal, which is what a shell expects to see. SIGHUP and SIGPIPE stay ignored where the caller
/// ignores them, as nohup does.
class DeferredInterrupts {
 public:
  DeferredInterrupts();
  ~DeferredInterrupts();
  DeferredInterrupts(const DeferredInterrupts&) = delete;
  DeferredInterrupts& operator=(const DeferredInterrupts&) = delete;

 private:
  sigset_t before_;
};

/// Raises the limit of the stack to what work needs, for this thread and for those to come.
/// @throws InputError if the system does not allow it (ulimit -s 64)
void provide_stack();

// Other programs that a command runs: builds of leviosim, git, what the user names.

/// Runs a program and waits for it. Its stdout and stderr go where those of leviosim's stderr go.
/// @param quiet  drops its stdout
/// @param words  the program, as a shell would find it, and its arguments
/// @returns its exit status, or 128 and the number of the signal that ended it
/// @throws InputError if it cannot be started, Interrupted
int run_child(const std::vector<std::string>& words, bool quiet = false);

/// What it prints on stdout, without the last line break; empty if it fails or is not there. What
/// it prints on stderr is dropped.
std::string output_of(const std::vector<std::string>& words);

// Where leviosim keeps what it can make again.

/// ${XDG_CACHE_HOME:-~/.cache}/leviosim, by the XDG base directory specification, which ignores
/// relative paths; need not exist. Without both variables /tmp/leviosim-UID, which is made for the
/// user alone.
/// @throws InputError if it belongs to another user, or could be used by another in /tmp
std::filesystem::path cache_folder();

}  // namespace leviosim::tools
