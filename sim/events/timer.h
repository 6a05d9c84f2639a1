// A timer that can be armed again and cancelled: the end of something whose pace may change.
//
// A model of shared resources arms the timer of every running segment again whenever the rates
// change; that costs no more than scheduling it the first time (sim/events/event_queue.h).
#pragma once

#include <coroutine>
#include <string>
#include <utility>

#include "sim/events/kernel.h"

namespace leviosim::sim {

class Timer {
 public:
  Timer(Kernel& kernel, std::string name);
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;
  ~Timer();

  /// Makes the timer expire at `time` (>= now()) in `phase`, and no more when it would have before.
  /// It counts as scheduled now among the events of its instant. An expiry nobody has awaited yet
  /// is forgotten.
  void arm(Time time, Phase phase = Phase::Run);
  /// Makes the timer not expire until it is armed again; who awaits it goes on waiting.
  void cancel();
  bool armed() const { return armed_; }

  struct Awaiter {
    Timer& timer;
    bool await_ready() const noexcept { return std::exchange(timer.expired_, false); }
    void await_suspend(std::coroutine_handle<> h) const { timer.wait(h); }
    void await_resume() const noexcept {}
  };
  /// co_await: continues when the timer expires, at once if it has since it was last awaited. At
  /// most one process awaits a timer. It need not be armed yet.
  Awaiter expired() { return {*this}; }

 private:
  friend class Kernel;
  void wait(std::coroutine_handle<> h);
  /// Returns who continues, or null and remembers.
  ProcessState* expire() {
    armed_ = false;
    expired_ = waiter_ == nullptr;
    return std::exchange(waiter_, nullptr);
  }

  Kernel& kernel_;
  Slot slot_;
  bool armed_ = false;
  bool expired_ = false;  // with nobody waiting
  ProcessState* waiter_ = nullptr;
  std::string name_;
};

}  // namespace leviosim::sim
