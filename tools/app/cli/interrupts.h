// Ctrl-C and termination requests, handled between two steps of work instead of in the middle of
// one, so that staged output is removed on the way out (sim/base/interruption.h).
#pragma once

#include <csignal>

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

}  // namespace leviosim::tools
