#include "sim/kernel/kernel.h"

#include <bit>
#include <utility>

#include "sim/kernel/timer.h"

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
  const Process::Handle handle = process.release();
  ProcessState& state = handle.promise();
  state.resume_point = handle;
  state.name = std::move(name);
  state.server = server;
  state.kernel = this;
  state.previous_process = last_process_;
  (last_process_ == nullptr ? first_process_ : last_process_->next_process) = &state;
  last_process_ = &state;
  schedule(now_, Phase::Run, state);
}

void Kernel::unlink(ProcessState& process) {
  ProcessState* const before = process.previous_process;
  ProcessState* const after = process.next_process;
  (before == nullptr ? first_process_ : before->next_process) = after;
  (after == nullptr ? last_process_ : after->previous_process) = before;
}

std::size_t Kernel::run() {
  check(!running_, "a kernel is run from within one of its processes");
  const Raised running(running_);
  while (execute_next(Time::max())) {
  }
  std::size_t deadlocked = 0;
  for (const ProcessState* p = first_process_; p != nullptr; p = p->next_process)
    deadlocked += p->server ? 0 : 1;
  return deadlocked;
}

void Kernel::run_until(Time end) {
  check(!running_, "a kernel is run from within one of its processes");
  check(end >= now_, "a kernel is run until a time that has passed");
  const Raised running(running_);
  while (execute_next(end)) {
  }
  now_ = end;
}

bool Kernel::execute_next(Time end) {
  future_.close_vacancy();
  timers_.close_vacancy();
  EventKey next = EventKey::last();
  const int phase = std::countr_zero(ready_phases_);
  if (ready_phases_ != 0) next = {now_, ready_[static_cast<std::size_t>(phase)].front().rank};
  const EventKey first_future = future_.first_key();
  const EventKey first_timer = timers_.first_key();

  if (first_timer < next && first_timer < first_future) {
    if (first_timer.time > end) return false;
    now_ = first_timer.time;
    if (ProcessState* const waiter = expire_first_timer()) execute(*waiter);
  } else if (first_future < next) {
    if (first_future.time > end) return false;
    now_ = first_future.time;
    execute(*future_.take_first());
  } else {
    if (ready_phases_ == 0) return false;
    ProcessList& ready = ready_[static_cast<std::size_t>(phase)];
    ProcessState& process = ready.pop();
    if (ready.empty()) ready_phases_ &= ready_phases_ - 1;
    execute(process);
  }
  return true;
}

void Kernel::execute(ProcessState& process) {
  ++events_executed_;
  current_ = &process;
  process.resume_point.resume();  // `process` may have ended with this
  if (failure_) [[unlikely]]
    rethrow_failure();
}

ProcessState* Kernel::expire_first_timer() {
  Timer& timer = *timers_.take_first();
  timer.expired_ = timer.waiter_ == nullptr;
  return std::exchange(timer.waiter_, nullptr);
}

void Kernel::rethrow_failure() { std::rethrow_exception(std::exchange(failure_, nullptr)); }

std::vector<BlockedProcess> Kernel::blocked() const {
  std::vector<BlockedProcess> processes;
  for (const ProcessState* p = first_process_; p != nullptr; p = p->next_process)
    if (p->waits_for != nullptr) processes.push_back({p->name, p->waits_for, p->server});
  return processes;
}

}  // namespace leviosim::sim
