// A simulated process: a coroutine the kernel owns and runs.
//
//   Process blink(Kernel& kernel, Duration half_period) {
//     for (;;) co_await kernel.delay(half_period);
//   }
//   kernel.spawn("blink", blink(kernel, half_period));
//
// Arguments taken by value live in the coroutine; those taken by reference must outlive it, and a
// lambda that is a coroutine must outlive it with its captures: prefer functions and arguments.
#pragma once

#include <coroutine>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "sim/events/event_queue.h"
#include "sim/events/frame_pool.h"

namespace leviosim::sim {

class Kernel;

/// The part of a process that the kernel and its wait lists work with. A process is at any time in
/// exactly one place: running, in the event queue, or in one wait list; so it carries the links.
struct ProcessState {
  ProcessState() = default;
  ProcessState(const ProcessState&) = delete;
  ProcessState& operator=(const ProcessState&) = delete;
  ~ProcessState();

  std::coroutine_handle<> resume_point;      ///< innermost suspended coroutine of this process
  ProcessState* next_in_list = nullptr;      ///< link of the list it waits in
  std::uint64_t rank = 0;                    ///< order among the ready, see EventKey
  Slot slot = 0;                             ///< its slot in the event queue
  const char* waits_for = nullptr;           ///< name of what must wake it; null when scheduled
  void* exchange = nullptr;                  ///< what it gives or gets, known to what it waits for
  Kernel* kernel = nullptr;                  ///< owner, once spawned
  ProcessState* previous_process = nullptr;  ///< links of the kernel's list of live processes
  ProcessState* next_process = nullptr;
  std::string name;
  bool server = false;
};

/// What ProcessState::waits_for says when that no longer exists.
inline constexpr const char* kDestroyed = "something destroyed meanwhile";

/// First in, first out; links through the processes themselves.
class ProcessList {
 public:
  bool empty() const { return head_ == nullptr; }
  ProcessState& front() const { return *head_; }
  void push(ProcessState& process) {
    process.next_in_list = nullptr;
    (head_ == nullptr ? head_ : tail_->next_in_list) = &process;
    tail_ = &process;
  }
  ProcessState& pop() {
    ProcessState& process = *head_;
    head_ = process.next_in_list;
    return process;
  }

 private:
  ProcessState* head_ = nullptr;
  ProcessState* tail_ = nullptr;
};

/// Return type of a process coroutine. It does not start before Kernel::spawn takes it over.
class [[nodiscard]] Process {
 public:
  struct promise_type : ProcessState, PooledFrame {
    Process get_return_object() { return Process(Handle::from_promise(*this)); }
    std::suspend_always initial_suspend() noexcept { return {}; }
    std::suspend_never final_suspend() noexcept { return {}; }  // frees itself at its end
    void return_void() {}
    void unhandled_exception();
  };
  using Handle = std::coroutine_handle<promise_type>;

  Process(Process&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Process& operator=(Process&&) = delete;
  ~Process() {
    if (handle_) handle_.destroy();
  }

 private:
  friend class Kernel;
  explicit Process(Handle handle) : handle_(handle) {}
  Handle release() { return std::exchange(handle_, nullptr); }

  Handle handle_;
};

}  // namespace leviosim::sim
