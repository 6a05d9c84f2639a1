#include "sim/kernel/timer.h"

#include <utility>

namespace leviosim::sim {

Timer::Timer(Kernel& kernel, std::string name) : kernel_(kernel), name_(std::move(name)) {}

Timer::~Timer() {
  if (armed()) kernel_.timers_.remove(heap_index);
  if (waiter_ != nullptr && !kernel_.closing()) waiter_->waits_for = kDestroyed;
}

void Timer::arm(Time time, Phase phase) {
  check(time >= kernel_.now(), "a timer is armed for the past");
  const EventKey key{time, kernel_.next_rank(phase)};
  expiry_ = time;
  expired_ = false;
  if (armed())
    kernel_.timers_.move(heap_index, key);
  else
    kernel_.timers_.push(key, this);
  if (waiter_ != nullptr) waiter_->waits_for = nullptr;
}

void Timer::cancel() {
  expired_ = false;
  if (armed()) kernel_.timers_.remove(heap_index);
  if (waiter_ != nullptr) waiter_->waits_for = name_.c_str();
}

void Timer::wait(std::coroutine_handle<> h) {
  check(waiter_ == nullptr, "two processes await one timer");
  waiter_ = &kernel_.suspend_current(h);
  waiter_->waits_for = armed() ? nullptr : name_.c_str();
}

}  // namespace leviosim::sim
