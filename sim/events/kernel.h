// Event kernel: simulated time advances from event to event; processes are C++20 coroutines.
//
// Models: one-shot events ordered by (time, phase, sequence) (sim/events/event_queue.h), processes
// that wait for time or for each other (sim/events/sync.h, channel.h, sync.h) and are composed of
// sub-coroutines (task.h). What is scheduled is always a process; a woken process never runs inside
// the one that wakes it, only later from the queue, in a fixed order.
//
// Leaves out: what a tick lasts (sim/events/timebase.h), signals with delta cycles, preemption, and
// waiting for one of several things at once. A kernel and its processes belong to one host thread
// at a time; independent kernels may run in several threads.
//
// Everything that refers to a kernel (processes' arguments, events, timers...) is destroyed before
// it or lives inside its processes.
#pragma once

#include <array>
#include <coroutine>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "sim/base/check.h"
#include "sim/events/event_queue.h"
#include "sim/events/process.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {

/// A process that nothing scheduled will wake.
struct BlockedProcess {
  std::string name;
  std::string waits_for;  ///< name of the event, barrier, semaphore, channel or timer
  bool server;            ///< whether waiting for ever is its normal end
};

class Timer;

class Kernel {
 public:
  Kernel() = default;
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
  /// Destroys the processes still alive, the latest spawned first.
  ~Kernel();

  Time now() const { return now_; }

  /// Takes over a process; it starts at the current time, in Phase::Run, in the order of spawning.
  void spawn(std::string name, Process process);
  /// Starts a process that serves others for ever: that it waits is no deadlock.
  void spawn_server(std::string name, Process process);

  /// Executes events until none is left. Returns how many processes, other than servers, are then
  /// blocked: 0 unless there is a deadlock. An exception that leaves a process leaves run(); the
  /// process is gone, the others stay as they are.
  std::size_t run();
  /// Executes all events up to and including `end` (>= now()); it is then `end`.
  void run_until(Time end);

  /// Processes that no scheduled event will wake, in the order of spawning.
  std::vector<BlockedProcess> blocked() const;
  std::uint64_t events_executed() const { return events_executed_; }

  struct TimeAwaiter {
    Kernel& kernel;
    Time time;
    Phase phase;
    bool await_ready() const noexcept { return false; }
    void await_suspend(std::coroutine_handle<> h) const {
      kernel.schedule(time, phase, kernel.suspend_current(h));
    }
    void await_resume() const noexcept {}
  };
  /// co_await: continues at now() + `duration` (>= 0). A delay of 0 lets all others run that are
  /// due in this instant up to `phase`.
  TimeAwaiter delay(Duration duration, Phase phase = Phase::Run) {
    check(duration >= Duration(0) && duration <= Time::max() - now_,
          "a delay is negative or beyond the end of time");
    return {*this, now_ + duration, phase};
  }
  /// co_await: continues at `time` (>= now()).
  TimeAwaiter at(Time time, Phase phase = Phase::Run) { return {*this, time, phase}; }

  // The rest is for awaitables.

  /// Records where the running process is to continue; the awaitable then files it somewhere.
  ProcessState& suspend_current(std::coroutine_handle<> resume_point) {
    current_->resume_point = resume_point;
    return *current_;
  }
  /// Makes a suspended process continue at `time` (>= now()).
  void schedule(Time time, Phase phase, ProcessState& process) {
    check(time >= now_, "an event is scheduled in the past");
    const std::uint64_t rank = next_rank(phase, process.slot);
    process.waits_for = nullptr;
    if (time == now_) {
      make_ready(phase, rank, process);
    } else {
      alarms_[process.slot].resume_point = process.resume_point;
      future_.set({time, rank});
    }
  }
  /// True while the kernel is destroyed: processes must no longer be touched.
  bool closing() const { return closing_; }

 private:
  friend class Timer;
  friend struct ProcessState;
  friend struct Process::promise_type;

  void adopt(std::string name, Process process, bool server);
  void unlink(ProcessState& process);
  /// Whose event it is when a slot's comes. A process's resume point is repeated here because
  /// following pointers to it is most of what an event costs.
  struct Alarm {
    std::coroutine_handle<> resume_point;
    ProcessState* process = nullptr;
    Timer* timer = nullptr;  ///< set for timers instead of the others
  };

  Slot add_alarm(const Alarm& alarm);
  void execute_all(Time end);
  void execute_first(ProcessList& ready);
  void execute_future();
  void resume(ProcessState& process, std::coroutine_handle<> resume_point);
  [[noreturn]] void rethrow_failure();
  std::uint64_t next_rank(Phase phase, Slot slot) {
    return event_rank(phase, next_sequence_++, slot);
  }
  void make_ready(Phase phase, std::uint64_t rank, ProcessState& process) {
    process.rank = rank;
    ready_[static_cast<std::size_t>(phase)].push(process);
    ready_phases_ |= 1U << static_cast<unsigned>(phase);
  }

  Time now_;
  ProcessState* current_ = nullptr;
  std::uint64_t next_sequence_ = 0;
  std::uint64_t events_executed_ = 0;
  std::array<ProcessList, kPhases> ready_;  // scheduled during the instant in which it is due
  unsigned ready_phases_ = 0;               // bit p: ready_[p] is not empty
  EventQueue future_;                       // everything else, and all timers
  std::vector<Alarm> alarms_;               // by slot
  std::exception_ptr failure_;              // what left the process that ran last
  ProcessState* first_process_ = nullptr;
  ProcessState* last_process_ = nullptr;
  bool running_ = false;
  bool closing_ = false;
};

}  // namespace leviosim::sim
