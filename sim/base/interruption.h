// Requests to stop (Ctrl-C, termination), as long work asks for them. A program that wants to end
// in order keeps the signals blocked (tools/app/cli/host.h); they then stay pending in the
// kernel, where every loop of every library can see them. There is no handler and no flag of ours.
// In a program that does not block them, nothing is ever pending, and signals do what they always
// do.
#pragma once

#include <csignal>
#include <exception>
#include <span>

namespace leviosim {

/// The user asked to stop.
class Interrupted : public std::exception {
 public:
  explicit Interrupted(int signal) : signal_(signal) {}
  const char* what() const noexcept override { return "interrupted"; }
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// SIGINT, SIGTERM, SIGHUP, and SIGPIPE: nobody reads the output any more.
std::span<const int> interrupting_signals();

/// The one that is pending in this thread or for the process; 0 if none is.
int pending_interrupt();

/// Costs a fraction of a microsecond. Work that takes longer than some 50 ms calls it at least that
/// often; parallel_for() does before every job.
/// @throws Interrupted if such a signal is pending
void throw_if_interrupted();

}  // namespace leviosim
