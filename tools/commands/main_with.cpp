#include "tools/commands/main_with.h"

#include <unistd.h>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <new>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/outputs/try_again.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/screen.h"
#include "tools/app/cli/version.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

constexpr int kBadInput = 2;
constexpr int kTryAgain = 75;  // EX_TEMPFAIL of sysexits.h
constexpr int kStopsBisecting = 128;
constexpr int kSignalled = 128;  // and its number; seen if the signal does not end the process

int fail(const std::exception& error, int status = kBadInput) {
  try {
    flush_results();  // what was done is shown all the same
  } catch (const std::exception&) {
    // It cannot be; if that is the error, it is said below.
  }
  print_error(error.what());
  return status;
}

/// Takes none.
int fail_without_memory() {
  std::fputs("leviosim: out of memory\n", stderr);
  return kBadInput;
}

/// Given back when memory ends. With the first, work goes on to where it may stop: destructors
/// allocate, too, as those of JSON documents do, and may throw nothing. With the other, what was
/// begun is unwound.
std::array<std::atomic<char*>, 2> reserves{new char[std::size_t{4} << 20],
                                           new char[std::size_t{4} << 20]};

std::atomic<bool> is_over{false};  ///< what follows stops nowhere

bool memory_ended() { return reserves[0] == nullptr; }

/// Of operator new, which tries again when this returns. The request to stop is seen by whatever
/// looks for a signal (sim/base/interruption.h).
void end_memory() {
  if (char* const first = reserves[0].exchange(nullptr)) {
    delete[] first;
    if (!is_over) ::kill(::getpid(), SIGTERM);
    return;
  }
  delete[] reserves[1].exchange(nullptr);
  throw std::bad_alloc();
}

/// So that the program does not end by its own signal.
void withdraw_request() {
  is_over = true;
  sigset_t own;
  sigemptyset(&own);
  sigaddset(&own, SIGTERM);
  constexpr timespec kAtOnce{};
  if (memory_ended()) sigtimedwait(&own, nullptr, &kAtOnce);
}

/// Where nothing may be thrown. The next run removes what was staged.
[[noreturn]] void end_terminated() {
  try {
    if (const std::exception_ptr failure = std::current_exception())
      std::rethrow_exception(failure);
  } catch (const std::bad_alloc&) {
    std::_Exit(fail_without_memory());
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  std::abort();
}

/// What was printed may be refused only now.
int end_after_report(int status) {
  try {
    flush_results();
    return status;
  } catch (const InputError& error) {
    return fail(error);
  } catch (const Interrupted& stop) {  // nobody reads it any more
    return memory_ended() ? fail_without_memory() : kSignalled + stop.signal();
  }
}

/// Says what was kept, to whoever asked the program to stop.
int end_interrupted(const Interrupted& stop, bool goes_on) {
  if (memory_ended()) return fail_without_memory();
  if (stop.signal() == SIGINT || stop.signal() == SIGTERM)
    print_error(goes_on
                    ? "interrupted: what was finished is kept; the same command goes on from there"
                    : "interrupted: nothing unfinished was kept; the same command begins anew");
  return kSignalled + stop.signal();
}

/// As results record them: none depends on how many are computed at a time, nor on what is shown.
Arguments without_jobs(const Arguments& typed) {
  Arguments words;
  for (std::size_t i = 0; i < typed.size(); ++i)
    if (typed[i] == "--jobs")
      ++i;
    else if (!typed[i].starts_with("--jobs=") && typed[i] != "--all")
      words.push_back(typed[i]);
  return words;
}

/// Under its title in the help.
Command grouped(Command command, std::string_view group) {
  command.app->group(group == "run"     ? "Run the workload"
                     : group == "ask"   ? "Ask what if, and what would help"
                     : group == "guard" ? "Guard the figures of a project"
                                        : "Trust: what the results rest on");
  return command;
}

int run_program(const Arguments& typed) {
  const Arguments words = without_jobs(typed);
  CLI::App app("Runs visual-inertial odometry on models of ultra-low-power multicore chips.",
               "leviosim");
  app.footer("leviosim help COMMAND: its options, with examples");
  app.set_version_flag("--version", fmt::format("leviosim {}", version()));
  std::vector<Command> commands;
  try {
#define LEVIOSIM_ADD(group, name) grouped(add_##name##_command(app, words), #group),
    commands = {LEVIOSIM_COMMANDS(LEVIOSIM_ADD)};
#undef LEVIOSIM_ADD
    const int status = run_command_line(app, commands, typed);
    flush_results();
    if (!memory_ended()) throw_if_interrupted();
    return status;
  } catch (const outputs::TryAgain& error) {
    return fail(error, kTryAgain);
  } catch (const InputError& error) {
    return fail(error);
  } catch (const EndsWith& end) {
    return end_after_report(end.status());
  } catch (const Interrupted& stop) {
    return end_interrupted(stop,
                           std::any_of(commands.begin(), commands.end(), [&](const Command& c) {
                             return c.goes_on && app.got_subcommand(c.app);
                           }));
  } catch (const std::bad_alloc&) {
    return fail_without_memory();
  } catch (const std::exception& error) {  // of a library or the system
    return fail(error);
  }
}

/// `git bisect run` takes 2 for a bad commit, and stops at others.
int status_for_git(const Arguments& typed, int status) {
  const bool is_asked = !typed.empty() && typed.front() == "bisect";
  const bool is_fault = status == kBadInput || status == kTryAgain;
  return is_asked && is_fault ? kStopsBisecting : status;
}

void add(std::vector<Workload> workloads) {
  for (Workload& workload : workloads) add_workload(std::move(workload));
}

int begin(const Arguments& typed, std::vector<Workload> workloads) {
  std::set_new_handler(end_memory);
  std::set_terminate(end_terminated);
  try {
    provide_stack();
    add(std::move(workloads));
  } catch (const InputError& error) {
    return fail(error);
  }
  return status_for_git(typed, run_program(typed));
}

}  // namespace
}  // namespace leviosim::tools

namespace leviosim {

int main_with(int argc, char** argv, std::vector<Workload> workloads) {
  const tools::DeferredInterrupts deferred;
  std::signal(SIGXFSZ, SIG_IGN);  // writing fails then, as on a full disk
  int status = 0;
  try {
    status = tools::begin(tools::Arguments(argv + 1, argv + argc), std::move(workloads));
  } catch (const std::bad_alloc&) {  // while it was begun, or a message was made
    status = tools::fail_without_memory();
  }
  tools::withdraw_request();
  return status;
}

}  // namespace leviosim
