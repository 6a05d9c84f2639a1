// A sub-coroutine of a process: lazily started, returns a value or an exception to its caller.
//
//   Task<Cycles> fetch(Dma& dma, Bytes size) { co_await dma.transfer(size); co_return ...; }
//   const Cycles waited = co_await fetch(dma, size);   // inside a Process or another Task
//
// The callee starts inside await_ready, on top of its caller; if it ends without ever waiting, the
// caller has not been suspended at all. Only a callee that did wait resumes its caller by symmetric
// transfer. A loop over callees that never wait therefore needs constant stack in every build;
// symmetric transfer alone would need a tail call there, which GCC makes only when optimising and
// never with a sanitizer.
#pragma once

#include <coroutine>
#include <exception>
#include <optional>
#include <type_traits>
#include <utility>

#include "sim/events/frame_pool.h"

namespace leviosim::sim {

namespace detail {

struct ResumeCaller {
  bool await_ready() noexcept { return false; }
  template <class Promise>
  std::coroutine_handle<> await_suspend(std::coroutine_handle<Promise> ended) noexcept {
    const std::coroutine_handle<> caller = ended.promise().caller;
    return caller ? caller : std::noop_coroutine();
  }
  void await_resume() noexcept {}
};

struct TaskPromiseBase : PooledFrame {
  std::suspend_always initial_suspend() noexcept { return {}; }
  ResumeCaller final_suspend() noexcept { return {}; }
  void unhandled_exception() noexcept { exception = std::current_exception(); }
  void rethrow_if_failed() const {
    if (exception) [[unlikely]]
      std::rethrow_exception(exception);
  }

  std::coroutine_handle<> caller;  // stays null while the task runs on top of its caller
  std::exception_ptr exception;
};

template <class T>
struct TaskPromise : TaskPromiseBase {
  template <class U = T>
  void return_value(U&& returned) {
    value.emplace(std::forward<U>(returned));
  }
  T result() {
    rethrow_if_failed();
    return std::move(*value);
  }

  std::optional<T> value;
};

template <>
struct TaskPromise<void> : TaskPromiseBase {
  void return_void() noexcept {}
  void result() const { rethrow_if_failed(); }
};

}  // namespace detail

template <class T = void>
class [[nodiscard]] Task {
  static_assert(!std::is_reference_v<T>, "return a pointer instead of a reference");

 public:
  struct promise_type : detail::TaskPromise<T> {
    Task get_return_object() { return Task(Handle::from_promise(*this)); }
  };
  using Handle = std::coroutine_handle<promise_type>;

  Task(Task&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Task& operator=(Task&&) = delete;
  ~Task() {
    if (handle_) handle_.destroy();
  }

  /// A task is awaited once: `co_await f()` or `co_await std::move(task)`.
  auto operator co_await() && noexcept {
    struct Awaiter {
      Handle callee;
      bool await_ready() const {
        callee.resume();
        return callee.done();
      }
      void await_suspend(std::coroutine_handle<> caller) const noexcept {
        callee.promise().caller = caller;
      }
      T await_resume() const { return callee.promise().result(); }
    };
    return Awaiter{handle_};
  }

 private:
  explicit Task(Handle handle) : handle_(handle) {}

  Handle handle_;
};

}  // namespace leviosim::sim
