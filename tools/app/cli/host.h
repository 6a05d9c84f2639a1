// Host services of commands: interrupts that are held back, and a larger stack.
//
// Ctrl-C and termination requests are handled between two steps of work instead of in the middle of
// one, so that staged output is removed on the way out (sim/base/interruption.h).
#pragma once

#include <csignal>

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

}  // namespace leviosim::tools
