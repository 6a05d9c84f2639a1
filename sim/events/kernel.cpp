#include "sim/events/kernel.h"

#include <bit>
#include <utility>

#include "sim/events/last_time.h"
#include "sim/events/sync.h"
#include "sim/events/timebase.h"
#include "sim/events/timer.h"

namespace leviosim::sim {
namespace {

/// Sets a flag for a scope, also when an exception leaves it.
class Raised {
 public:
  explicit Raised(bool& flag) : flag_(flag) { flag_ = true; }
  Raised(const Raised&) = delete;
  Raised& operator=(const Raised&) = delete;
  ~Raised() { flag_ = false; }

 private:
  bool& flag_;
};

}  // namespace

ProcessState::~ProcessState() {
  if (kernel != nullptr) kernel->unlink(*this);
}

void Process::promise_type::unhandled_exception() { kernel->failure_ = std::current_exception(); }

Kernel::~Kernel() {
  closing_ = true;
  while (last_process_ != nullptr)
    Process::Handle::from_promise(static_cast<Process::promise_type&>(*last_process_)).destroy();
}

void Kernel::spawn(std::string name, Process process) {
  adopt(std::move(name), std::move(process), false);
}

void Kernel::spawn_server(std::string name, Process process) {
  adopt(std::move(name), std::move(process), true);
}

void Kernel::adopt(std::string name, Process process, bool server) {
  check(!closing_, "a process is spawned while its kernel is destroyed");
  const Slot slot = add_alarm({});  // may throw: the process is still its own
  const Process::Handle handle = process.release();
  ProcessState& state = handle.promise();
  state.resume_point = handle;
  state.name = std::move(name);
  state.server = server;
  state.kernel = this;
  state.slot = slot;
  alarms_[slot] = {handle, &state, nullptr};
  state.previous_process = last_process_;
  (last_process_ == nullptr ? first_process_ : last_process_->next_process) = &state;
  last_process_ = &state;
  schedule(now_, Phase::Run, state);
}

Slot Kernel::add_alarm(const Alarm& alarm) {
  const Slot slot = future_.add_slot();
  if (slot >= alarms_.size()) alarms_.resize(slot + 1);
  alarms_[slot] = alarm;
  return slot;
}

void Kernel::unlink(ProcessState& process) {
  future_.free_slot(process.slot);
  ProcessState* const before = process.previous_process;
  ProcessState* const after = process.next_process;
  (before == nullptr ? first_process_ : before->next_process) = after;
  (after == nullptr ? last_process_ : after->previous_process) = before;
}

std::size_t Kernel::run() {
  check(!running_, "a kernel is run from within one of its processes");
  const Raised running(running_);
  execute_all(kLastTime);
  if (future_.first() != EventKey::never()) fail_beyond_time();
  std::size_t deadlocked = 0;
  for (const ProcessState* p = first_process_; p != nullptr; p = p->next_process)
    deadlocked += p->server ? 0 : 1;
  return deadlocked;
}

void Kernel::run_until(Time end) {
  check(!running_, "a kernel is run from within one of its processes");
  check(end >= now_, "a kernel is run until a time that has passed");
  const Raised running(running_);
  execute_all(end);
  now_ = end;
}

void Kernel::execute_all(Time end) {
  for (;;) {
    const EventKey next = future_.first();
    if (ready_phases_ != 0) {
      ProcessList& ready = ready_[static_cast<std::size_t>(std::countr_zero(ready_phases_))];
      if (EventKey{now_, ready.front().rank} < next) {
        execute_first(ready);
        continue;
      }
    }
    if (next.time > end || next == EventKey::never()) return;
    now_ = next.time;
    execute_future();
  }
}

void Kernel::execute_first(ProcessList& ready) {
  ProcessState& process = ready.pop();
  if (ready.empty()) ready_phases_ &= ready_phases_ - 1;  // `ready` is that of the lowest bit
  resume(process, process.resume_point);
}

void Kernel::execute_future() {
  const Alarm& alarm = alarms_[future_.take_first()];
  if (alarm.timer == nullptr) {
    resume(*alarm.process, alarm.resume_point);
  } else if (ProcessState* const waiter = alarm.timer->expire()) {
    resume(*waiter, waiter->resume_point);
  }
}

void Kernel::resume(ProcessState& process, std::coroutine_handle<> resume_point) {
  ++events_executed_;
  current_ = &process;
  resume_point.resume();  // `process` may have ended with this
  if (failure_) [[unlikely]]
    rethrow_failure();
}

void Kernel::rethrow_failure() { std::rethrow_exception(std::exchange(failure_, nullptr)); }

std::vector<BlockedProcess> Kernel::blocked() const {
  std::vector<BlockedProcess> processes;
  for (const ProcessState* p = first_process_; p != nullptr; p = p->next_process)
    if (p->waits_for != nullptr) processes.push_back({p->name, p->waits_for, p->server});
  return processes;
}

}  // namespace leviosim::sim
