// Ctrl-C and termination requests, handled between two steps of work instead of in the middle of
// one, so that staged output is removed on the way out. There is no signal handler and no global
// flag: the signals stay blocked, and long-running commands ask whether one is pending.
#pragma once

#include <csignal>
#include <exception>

namespace leviosim::tools {

/// The user asked to stop.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Holds back SIGINT, SIGTERM and SIGHUP during its life, in this thread and in threads started
/// meanwhile. What has arrived takes its usual effect at the end: the process dies of the signal,
/// which is what a shell expects to see.
class DeferredInterrupts {
 public:
  DeferredInterrupts();
  ~DeferredInterrupts();
  DeferredInterrupts(const DeferredInterrupts&) = delete;
  DeferredInterrupts& operator=(const DeferredInterrupts&) = delete;

 private:
  sigset_t before_;
};

/// @throws Interrupted if a deferred signal has arrived
void throw_if_interrupted();

}  // namespace leviosim::tools
