// What processes wait for each other with: Event, Barrier, Semaphore; and timers. (Values:
// channel.h.)
//
// All wake in the order of arrival, at the current time, in Phase::Wake. None models a cost by
// itself, except that a barrier takes a latency; hardware costs are the chip model's business.
#pragma once

#include <coroutine>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "sim/events/kernel.h"

namespace leviosim::sim {

/// A named queue of waiting processes: what the others are made of.
class WaitQueue {
 public:
  WaitQueue(Kernel& kernel, std::string name) : kernel_(kernel), name_(std::move(name)) {}
  WaitQueue(const WaitQueue&) = delete;
  WaitQueue& operator=(const WaitQueue&) = delete;
  ~WaitQueue();

  Kernel& kernel() const { return kernel_; }
  const std::string& name() const { return name_; }
  bool empty() const { return waiting_.empty(); }
  ProcessState& front() const { return waiting_.front(); }

  /// Suspends the running process here. `exchange`: what it gives or gets meanwhile.
  void wait(std::coroutine_handle<> h, void* exchange = nullptr) {
    ProcessState& process = kernel_.suspend_current(h);
    process.waits_for = name_.c_str();
    process.exchange = exchange;
    waiting_.push(process);
  }
  void wake_first() { kernel_.schedule(kernel_.now(), Phase::Wake, waiting_.pop()); }
  void wake_all(Duration latency = Duration(0)) {
    const Time time = kernel_.now() + latency;
    while (!waiting_.empty()) kernel_.schedule(time, Phase::Wake, waiting_.pop());
  }

 private:
  Kernel& kernel_;
  ProcessList waiting_;
  std::string name_;
};

/// Wakes whoever is waiting when it is notified; it does not remember.
class Event {
 public:
  Event(Kernel& kernel, std::string name) : queue_(kernel, std::move(name)) {}

  void notify() {
    if (!queue_.kernel().closing()) queue_.wake_all();
  }

  struct Awaiter {
    WaitQueue& queue;
    bool await_ready() const noexcept { return false; }
    void await_suspend(std::coroutine_handle<> h) const { queue.wait(h); }
    void await_resume() const noexcept {}
  };
  /// co_await: continues after the next notify().
  Awaiter wait() { return {queue_}; }

 private:
  WaitQueue queue_;
};

/// Holds `parties` arrivals until the last, then releases all of them `latency` later, in the order
/// of arrival. It can be used again at once.
class Barrier {
 public:
  Barrier(Kernel& kernel, std::string name, std::size_t parties, Duration latency = Duration(0));

  std::size_t parties() const { return parties_; }
  std::size_t arrived() const { return arrived_; }

  struct Awaiter {
    Barrier& barrier;
    bool await_ready() const noexcept { return false; }
    void await_suspend(std::coroutine_handle<> h) const { barrier.arrive_at(h); }
    void await_resume() const noexcept {}
  };
  /// co_await: arrives, and continues at the release.
  Awaiter arrive() { return {*this}; }

 private:
  void arrive_at(std::coroutine_handle<> h) {
    queue_.wait(h);
    if (++arrived_ < parties_) return;
    arrived_ = 0;
    queue_.wake_all(latency_);
  }

  WaitQueue queue_;
  std::size_t parties_;
  std::size_t arrived_ = 0;
  Duration latency_;
};

/// A number of equal permits, given first come first served: a large request that waits is not
/// overtaken by a small one.
class Semaphore {
 public:
  Semaphore(Kernel& kernel, std::string name, std::int64_t permits);

  /// Gives permits back (>= 0) and wakes those whose requests they satisfy.
  void release(std::int64_t permits = 1);

  struct Awaiter {
    Semaphore& semaphore;
    std::int64_t permits;
    bool await_ready() const noexcept { return semaphore.take_now(permits); }
    void await_suspend(std::coroutine_handle<> h) { semaphore.queue_.wait(h, &permits); }
    void await_resume() const noexcept {}
  };
  /// co_await: continues once it owns `permits` (>= 0) permits.
  Awaiter acquire(std::int64_t permits = 1);

 private:
  bool take_now(std::int64_t permits) {
    if (!queue_.empty() || permits > available_) return false;
    available_ -= permits;
    return true;
  }

  WaitQueue queue_;
  std::int64_t available_;
};

}  // namespace leviosim::sim
