#include "sim/base/interruption.h"

#include <array>

namespace leviosim {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP, SIGPIPE};

}  // namespace

std::span<const int> interrupting_signals() { return kSignals; }

int pending_interrupt() {
  sigset_t pending;
  sigpending(&pending);
  for (const int signal : kSignals)
    if (sigismember(&pending, signal) == 1) return signal;
  return 0;
}

void throw_if_interrupted() {
  if (const int signal = pending_interrupt(); signal != 0) throw Interrupted(signal);
}

}  // namespace leviosim
