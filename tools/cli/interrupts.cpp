#include "tools/cli/interrupts.h"

#include <array>

namespace leviosim::tools {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

}  // namespace

DeferredInterrupts::DeferredInterrupts() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : kSignals) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

DeferredInterrupts::~DeferredInterrupts() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

void throw_if_interrupted() {
  sigset_t pending;
  sigpending(&pending);
  for (const int signal : kSignals)
    if (sigismember(&pending, signal) == 1) throw Interrupted();
}

}  // namespace leviosim::tools
