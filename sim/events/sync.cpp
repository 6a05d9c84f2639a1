#include "sim/events/sync.h"

#include "sim/base/check.h"

namespace leviosim::sim {

WaitQueue::~WaitQueue() {
  if (kernel_.closing()) return;
  while (!waiting_.empty()) waiting_.pop().waits_for = kDestroyed;
}

Barrier::Barrier(Kernel& kernel, std::string name, std::size_t parties, Duration latency)
    : queue_(kernel, std::move(name)), parties_(parties), latency_(latency) {
  check(parties > 0, "a barrier has no parties");
  check(latency >= Duration(0), "a barrier's latency is negative");
}

Semaphore::Semaphore(Kernel& kernel, std::string name, std::int64_t permits)
    : queue_(kernel, std::move(name)), available_(permits) {
  check(permits >= 0, "a semaphore starts with a negative number of permits");
}

Semaphore::Awaiter Semaphore::acquire(std::int64_t permits) {
  check(permits >= 0, "a negative number of permits is acquired");
  return {*this, permits};
}

void Semaphore::release(std::int64_t permits) {
  check(permits >= 0, "a negative number of permits is released");
  available_ += permits;
  if (queue_.kernel().closing()) return;
  while (!queue_.empty()) {
    const std::int64_t wanted = *static_cast<const std::int64_t*>(queue_.front().exchange);
    if (wanted > available_) return;
    available_ -= wanted;
    queue_.wake_first();
  }
}

}  // namespace leviosim::sim
