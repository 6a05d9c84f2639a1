// The benchmark networks as leviosim processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "sim/events/channel.h"
#include "sim/events/kernel.h"
#include "sim/events/sync.h"
#include "sim/events/task.h"
#include "sim/events/timer.h"
#include "tests/bench/event_kernel_networks.h"

namespace leviosim::bench::own {

using sim::Barrier;
using sim::Channel;
using sim::Duration;
using sim::Event;
using sim::Kernel;
using sim::Process;
using sim::Task;
using sim::Time;
using sim::Timer;

/// What all networks share: a kernel, the signal to start, and the count of steps.
class Network {
 public:
  RunResult run() {
    const Time begin = kernel_.now();
    steps_ = 0;
    start_.notify();
    kernel_.run();
    return {steps_, (kernel_.now() - begin).count()};
  }

 protected:
  Kernel kernel_;
  Event start_{kernel_, "start"};
  std::int64_t steps_ = 0;
};

/// Processes that wait for varying times and meet at a barrier after every eighth wait.
class DelayBarrier : public Network {
 public:
  DelayBarrier(std::size_t processes, int rounds)
      : barrier_(kernel_, "barrier", processes, Duration(kBarrierLatency)), rounds_(rounds) {
    for (std::size_t p = 0; p < processes; ++p) kernel_.spawn_server("worker", worker(p));
    kernel_.run();
  }

 private:
  Process worker(std::size_t id) {
    const DelayTable delays(id);
    for (;;) {
      co_await start_.wait();
      std::size_t n = 0;
      for (int round = 0; round < rounds_; ++round) {
        for (int i = 0; i < kDelaysPerBarrier; ++i, ++steps_)
          co_await kernel_.delay(Duration(delays[n++]));
        co_await barrier_.arrive();
        ++steps_;
      }
    }
  }

  Barrier barrier_;
  int rounds_;
};

/// The same, with the work between two barriers in a sub-coroutine.
class TaskBarrier : public Network {
 public:
  TaskBarrier(std::size_t processes, int rounds)
      : barrier_(kernel_, "barrier", processes, Duration(kBarrierLatency)), rounds_(rounds) {
    for (std::size_t p = 0; p < processes; ++p) kernel_.spawn_server("worker", worker(p));
    kernel_.run();
  }

 private:
  Task<> execute(int cycles) {
    co_await kernel_.delay(Duration(cycles));
    ++steps_;
  }
  Process worker(std::size_t id) {
    const DelayTable delays(id);
    for (;;) {
      co_await start_.wait();
      std::size_t n = 0;
      for (int round = 0; round < rounds_; ++round) {
        for (int i = 0; i < kDelaysPerBarrier; ++i) co_await execute(delays[n++]);
        co_await barrier_.arrive();
        ++steps_;
      }
    }
  }

  Barrier barrier_;
  int rounds_;
};

/// A ring of processes that wake each other by events in the same instant; one cycle a round.
class Ring : public Network {
 public:
  Ring(std::size_t processes, int rounds) : rounds_(rounds) {
    for (std::size_t p = 0; p < processes; ++p) events_.emplace_back(kernel_, "token");
    kernel_.spawn_server("starter", starter());
    for (std::size_t p = 1; p < processes; ++p) kernel_.spawn_server("member", member(p));
    kernel_.run();
  }

 private:
  Process starter() {
    for (;;) {
      co_await start_.wait();
      for (int round = 0; round < rounds_; ++round, steps_ += 2) {
        co_await kernel_.delay(Duration(1));
        events_[1].notify();
        co_await events_[0].wait();
      }
    }
  }
  Process member(std::size_t id) {
    Event& mine = events_[id];
    Event& next = events_[(id + 1) % events_.size()];
    for (;; ++steps_) {
      co_await mine.wait();
      next.notify();
    }
  }

  std::deque<Event> events_;
  int rounds_;
};

/// A producer, stages that each take varying times, and a consumer, with bounded FIFOs between.
class Pipeline : public Network {
 public:
  Pipeline(std::size_t processes, int values) : values_(values) {
    for (std::size_t p = 0; p + 1 < processes; ++p)
      fifos_.emplace_back(kernel_, "fifo", kFifoDepth);
    kernel_.spawn_server("producer", producer());
    for (std::size_t p = 1; p + 1 < processes; ++p) kernel_.spawn_server("stage", stage(p));
    kernel_.spawn_server("consumer", consumer());
    kernel_.run();
  }

 private:
  Process producer() {
    for (;;) {
      co_await start_.wait();
      for (int value = 0; value < values_; ++value, ++steps_) co_await fifos_.front().push(value);
    }
  }
  Process stage(std::size_t id) {
    const DelayTable delays(id);
    Channel<int>& in = fifos_[id - 1];
    Channel<int>& out = fifos_[id];
    for (std::size_t n = 0;; steps_ += 3) {
      const int value = co_await in.pop();
      co_await kernel_.delay(Duration(delays[n++]));
      co_await out.push(value + 1);
    }
  }
  Process consumer() {
    for (;; ++steps_) co_await fifos_.back().pop();
  }

  std::deque<Channel<int>> fifos_;
  int values_;
};

/// Segments that share a resource: whenever one ends, the ends of all others are moved.
class SharedRate : public Network {
 public:
  SharedRate(std::size_t processes, int segments) : segments_(segments), ends_(processes) {
    for (std::size_t p = 0; p < processes; ++p) timers_.emplace_back(kernel_, "segment end");
    for (std::size_t p = 0; p < processes; ++p) kernel_.spawn_server("core", core(p));
    kernel_.run();
  }

 private:
  Process core(std::size_t id) {
    const DelayTable delays(id);
    for (;;) {
      co_await start_.wait();
      std::size_t n = 0;
      for (int i = 0; i < segments_; ++i, ++steps_) {
        ends_[id] = kernel_.now() + Duration(16 + delays[n++]);
        move_ends();
        co_await timers_[id].expired();
        ends_[id] = Time{};
      }
    }
  }
  void move_ends() {
    for (std::size_t p = 0; p < ends_.size(); ++p) {
      if (ends_[p] <= kernel_.now()) continue;
      ends_[p] = ends_[p] + Duration(1);
      timers_[p].arm(ends_[p]);
    }
  }

  int segments_;
  std::vector<Time> ends_;
  std::deque<Timer> timers_;
};

}  // namespace leviosim::bench::own
