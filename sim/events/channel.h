// A bounded first-in-first-out channel of values between processes.
//
// A producer waits while the channel is full, a consumer while it is empty; both are served in the
// order of arrival. A value meant for a waiting consumer is handed to it directly, so that no third
// process can take it in between. With capacity 1 it is a mailbox.
#pragma once

#include <coroutine>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/check.h"
#include "sim/events/sync.h"

namespace leviosim::sim {

template <class T>
class Channel {
 public:
  /// `capacity` > 0 values.
  Channel(Kernel& kernel, const std::string& name, std::size_t capacity)
      : producers_(kernel, name + " (full)"),
        consumers_(kernel, name + " (empty)"),
        slots_(capacity) {
    check(capacity > 0, "a channel has no capacity");
  }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return slots_.size(); }

  /// Takes the oldest value, if there is one.
  std::optional<T> try_pop() {
    if (size_ == 0) return std::nullopt;
    return take();
  }

  struct PushAwaiter {
    Channel& channel;
    T value;
    bool await_ready() {
      const bool room = channel.size_ < channel.capacity();
      if (room) channel.put(std::move(value));
      return room;
    }
    void await_suspend(std::coroutine_handle<> h) { channel.producers_.wait(h, &value); }
    void await_resume() const noexcept {}
  };
  /// co_await: continues once the value is in the channel.
  PushAwaiter push(T value) { return {*this, std::move(value)}; }

  struct PopAwaiter {
    Channel& channel;
    std::optional<T> value;
    bool await_ready() {
      value = channel.try_pop();
      return value.has_value();
    }
    void await_suspend(std::coroutine_handle<> h) { channel.consumers_.wait(h, &value); }
    T await_resume() { return std::move(*value); }
  };
  /// co_await: the oldest value, once there is one.
  PopAwaiter pop() { return {*this, std::nullopt}; }

 private:
  std::size_t wrapped(std::size_t index) const {
    return index < capacity() ? index : index - capacity();
  }

  void put(T value) {
    if (consumers_.empty()) {
      slots_[wrapped(first_ + size_)] = std::move(value);
      ++size_;
      return;
    }
    *static_cast<std::optional<T>*>(consumers_.front().exchange) = std::move(value);
    consumers_.wake_first();
  }

  T take() {
    T value = std::move(*slots_[first_]);
    slots_[first_].reset();
    first_ = wrapped(first_ + 1);
    --size_;
    if (!producers_.empty()) {
      put(std::move(*static_cast<T*>(producers_.front().exchange)));
      producers_.wake_first();
    }
    return value;
  }

  WaitQueue producers_;
  WaitQueue consumers_;
  std::vector<std::optional<T>> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace leviosim::sim
