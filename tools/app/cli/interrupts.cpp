#include "tools/app/cli/interrupts.h"

namespace leviosim::tools {
namespace {

/// Shells start background jobs with SIGINT ignored; one that is sent all the same is meant.
bool stays_ignored(int signal) {
  if (signal != SIGHUP && signal != SIGPIPE) return false;
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

DeferredInterrupts::DeferredInterrupts() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : interrupting_signals())
    if (!stays_ignored(signal)) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

DeferredInterrupts::~DeferredInterrupts() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

}  // namespace leviosim::tools
