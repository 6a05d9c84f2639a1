// A timer that can be armed again and cancelled: the end of something whose pace may change.
//
// A model of shared resources arms the timer of every running segment again whenever the rates
// change. The kernel keeps armed timers in an indexed heap: arming again moves the entry in place,
// nothing stale is left behind.
#pragma once

#include <coroutine>
#include <cstddef>
#include <string>

#include "sim/kernel/event_queue.h"
#include "sim/kernel/kernel.h"

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
  bool armed() const { return heap_index != EventHeap<Timer*>::kAbsent; }
  /// When it will expire, while armed.
  Time expiry() const { return expiry_; }

  struct Awaiter {
    Timer& timer;
    bool await_ready() const noexcept { return std::exchange(timer.expired_, false); }
    void await_suspend(std::coroutine_handle<> h) const { timer.wait(h); }
    void await_resume() const noexcept {}
  };
  /// co_await: continues when the timer expires, at once if it has since it was last awaited. At
  /// most one process awaits a timer. It need not be armed yet.
  Awaiter expired() { return {*this}; }

  std::size_t heap_index = EventHeap<Timer*>::kAbsent;  ///< kept by the kernel

 private:
  friend class Kernel;
  void wait(std::coroutine_handle<> h);

  Kernel& kernel_;
  ProcessState* waiter_ = nullptr;
  Time expiry_;
  bool expired_ = false;
  std::string name_;
};

}  // namespace leviosim::sim
