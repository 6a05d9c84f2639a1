#include "sim/events/timer.h"

#include "sim/base/check.h"

namespace leviosim::sim {

Timer::Timer(Kernel& kernel, std::string name)
    : kernel_(kernel), slot_(kernel.add_alarm({{}, nullptr, this})), name_(std::move(name)) {}

Timer::~Timer() {
  kernel_.future_.free_slot(slot_);
  if (waiter_ != nullptr && !kernel_.closing()) waiter_->waits_for = kDestroyed;
}

void Timer::arm(Time time, Phase phase) {
  check(time >= kernel_.now(), "a timer is armed for the past");
  kernel_.future_.set({time, kernel_.next_rank(phase, slot_)});
  armed_ = true;
  expired_ = false;
  if (waiter_ != nullptr) waiter_->waits_for = nullptr;
}

void Timer::cancel() {
  if (armed_) kernel_.future_.cancel(slot_);
  armed_ = false;
  expired_ = false;
  if (waiter_ != nullptr) waiter_->waits_for = name_.c_str();
}

void Timer::wait(std::coroutine_handle<> h) {
  check(waiter_ == nullptr, "two processes await one timer");
  waiter_ = &kernel_.suspend_current(h);
  waiter_->waits_for = armed_ ? nullptr : name_.c_str();
}

}  // namespace leviosim::sim
