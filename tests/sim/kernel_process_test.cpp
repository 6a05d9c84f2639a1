// Life of processes: names of the blocked, exceptions, and that nothing is leaked.
#include "sim/events/process.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/events/channel.h"
#include "sim/events/kernel.h"
#include "sim/events/sync.h"
#include "sim/events/task.h"
#include "sim/events/timer.h"

namespace leviosim::sim {
namespace {

using Token = std::shared_ptr<int>;  // use_count() tells how many coroutines hold it

Process wait_forever(Event& event, Token) { co_await event.wait(); }

Process arrive_once(Barrier& barrier) { co_await barrier.arrive(); }

Process acquire_once(Semaphore& semaphore) { co_await semaphore.acquire(2); }

Process pop_once(Channel<int>& channel) { co_await channel.pop(); }

Process push_twice(Channel<int>& channel) {
  co_await channel.push(1);
  co_await channel.push(2);
}

Process sleep(Kernel& kernel, Duration duration) { co_await kernel.delay(duration); }

TEST(KernelProcess, BlockedProcessesAreNamedWithWhatTheyWaitFor) {
  Kernel kernel;
  Event event(kernel, "frame ready");
  Barrier barrier(kernel, "join", 2);
  Semaphore semaphore(kernel, "dma slots", 1);
  Channel<int> work(kernel, "work", 1);
  Channel<int> results(kernel, "results", 1);
  kernel.spawn("fc", wait_forever(event, nullptr));
  kernel.spawn("core0", arrive_once(barrier));
  kernel.spawn("done", sleep(kernel, Duration(5)));
  kernel.spawn("dma", acquire_once(semaphore));
  kernel.spawn_server("core1", pop_once(work));
  kernel.spawn("core2", push_twice(results));
  EXPECT_EQ(kernel.run(), 4U);  // the server may wait for ever

  std::vector<std::string> lines;
  for (const BlockedProcess& process : kernel.blocked())
    lines.push_back(process.name + ": " + process.waits_for + (process.server ? " (server)" : ""));
  EXPECT_EQ(lines,
            (std::vector<std::string>{"fc: frame ready", "core0: join", "dma: dma slots",
                                      "core1: work (empty) (server)", "core2: results (full)"}));
}

TEST(KernelProcess, WaitingForTimeIsNotBlocked) {
  Kernel kernel;
  kernel.spawn("sleeper", sleep(kernel, Duration(10)));
  kernel.run_until(Time{5});
  EXPECT_TRUE(kernel.blocked().empty());
  EXPECT_EQ(kernel.run(), 0U);
}

TEST(KernelProcess, WhatItWaitedForMayBeDestroyed) {
  Kernel kernel;
  {
    Event event(kernel, "short-lived");
    kernel.spawn("p", wait_forever(event, nullptr));
    kernel.run();
  }
  ASSERT_EQ(kernel.blocked().size(), 1U);
  EXPECT_EQ(kernel.blocked()[0].waits_for, kDestroyed);
}

TEST(KernelProcess, StartsInTheOrderOfSpawningNotBefore) {
  Kernel kernel;
  const Token token = std::make_shared<int>();
  Event event(kernel, "event");
  kernel.spawn("p", wait_forever(event, token));
  EXPECT_TRUE(kernel.blocked().empty());  // not started yet
  EXPECT_EQ(token.use_count(), 2);
  EXPECT_EQ(kernel.events_executed(), 0U);
}

TEST(KernelProcess, AFinishedProcessIsFreedAtOnce) {
  Kernel kernel;
  const Token token = std::make_shared<int>();
  Event event(kernel, "event");
  kernel.spawn("p", wait_forever(event, token));
  kernel.run();
  EXPECT_EQ(token.use_count(), 2);
  event.notify();
  kernel.run();
  EXPECT_EQ(token.use_count(), 1);
}

TEST(KernelProcess, AProcessNeverSpawnedIsFreed) {
  Kernel kernel;
  const Token token = std::make_shared<int>();
  Event event(kernel, "event");
  { const Process process = wait_forever(event, token); }
  EXPECT_EQ(token.use_count(), 1);
}

Task<> hold(Kernel& kernel, Channel<Token>& channel, Token token) {
  Timer timer(kernel, "inner");
  timer.arm(kernel.now() + Duration(1000));
  co_await channel.push(token);
  co_await channel.push(token);  // waits with the value in hand
}

Process live_on(Kernel& kernel, Channel<Token>& channel, Token token) {
  Barrier own(kernel, "own", 3);
  co_await kernel.delay(Duration(1));
  co_await hold(kernel, channel, token);
}

TEST(KernelProcess, AKernelDestroyedWithLiveProcessesLeaksNothing) {
  const Token token = std::make_shared<int>();
  {
    Kernel kernel;
    Event event(kernel, "event");
    Channel<Token> channel(kernel, "channel", 1);
    for (int i = 0; i < 10; ++i) {
      kernel.spawn("live", live_on(kernel, channel, token));
      kernel.spawn("waiting", wait_forever(event, token));
    }
    kernel.run_until(Time{100});
    kernel.spawn("not started", wait_forever(event, token));
    EXPECT_GT(token.use_count(), 21);
  }
  EXPECT_EQ(token.use_count(), 1);
}

/// What processes share by owning it together.
struct Shared {
  explicit Shared(Kernel& kernel) : event(kernel, "event"), semaphore(kernel, "semaphore", 0) {}
  Event event;
  Semaphore semaphore;
};

/// Touches what it used when it is destroyed, as guards do.
struct NotifyAtEnd {
  std::shared_ptr<Shared> shared;
  ~NotifyAtEnd() {
    shared->event.notify();
    shared->semaphore.release(2);
  }
};

Process notify_at_end(Kernel& kernel, std::shared_ptr<Shared> shared) {
  const NotifyAtEnd guard{std::move(shared)};
  co_await kernel.delay(Duration(1'000'000));
}

TEST(KernelProcess, DestructorsMayNotifyWhileTheKernelIsDestroyed) {
  Kernel kernel;
  auto shared = std::make_shared<Shared>(kernel);
  kernel.spawn("notifier", notify_at_end(kernel, shared));
  kernel.spawn("waiter", wait_forever(shared->event, nullptr));
  kernel.spawn("acquirer", acquire_once(shared->semaphore));
  shared.reset();
  kernel.run_until(Time{10});
  EXPECT_EQ(kernel.blocked().size(), 2U);
}

Process refuse(Kernel& kernel, Token) {
  co_await kernel.delay(Duration(3));
  throw InputError("bad input");
}

TEST(KernelProcess, AnExceptionLeavesRunAndFreesTheProcess) {
  Kernel kernel;
  const Token token = std::make_shared<int>();
  kernel.spawn("refusing", refuse(kernel, token));
  kernel.spawn("other", sleep(kernel, Duration(7)));
  EXPECT_THROW(kernel.run(), InputError);
  EXPECT_EQ(token.use_count(), 1);
  EXPECT_EQ(kernel.now(), Time{3});
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(kernel.now(), Time{7});
}

Process spawn_children(Kernel& kernel, int depth, int& count) {
  ++count;
  co_await kernel.delay(Duration(1));
  if (depth == 0) co_return;
  for (int i = 0; i < 3; ++i) kernel.spawn("child", spawn_children(kernel, depth - 1, count));
}

TEST(KernelProcess, ProcessesMaySpawnProcesses) {
  Kernel kernel;
  int count = 0;
  kernel.spawn("root", spawn_children(kernel, 5, count));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(count, (729 - 1) / 2);
  EXPECT_EQ(kernel.now(), Time{6});
}

Task<std::int64_t> slow_sum(Kernel& kernel, std::int64_t value) {
  co_await kernel.delay(Duration(value % 7));
  co_return value;
}

Process sum_up(Kernel& kernel, std::int64_t& total) {
  for (std::int64_t i = 0; i < 5000; ++i) total += co_await slow_sum(kernel, i);
}

TEST(KernelProcess, KernelsRunInSeveralThreads) {
  std::vector<std::int64_t> totals(4);
  std::vector<std::thread> threads;
  for (std::int64_t& total : totals)
    threads.emplace_back([&total] {
      Kernel kernel;
      kernel.spawn("sum", sum_up(kernel, total));
      kernel.run();
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::int64_t total : totals) EXPECT_EQ(total, 4999 * 5000 / 2);
}

TEST(KernelProcess, AKernelMayBeDestroyedInAnotherThread) {
  auto kernel = std::make_unique<Kernel>();
  std::int64_t total = 0;
  kernel->spawn("sum", sum_up(*kernel, total));
  kernel->run_until(Time{100});
  std::thread([&kernel] { kernel.reset(); }).join();
  EXPECT_GT(total, 0);
}

Process run_again(Kernel& kernel) {
  kernel.run();
  co_return;
}

TEST(KernelProcessDeathTest, AProcessCannotRunItsKernel) {
  Kernel kernel;
  kernel.spawn("p", run_again(kernel));
  EXPECT_DEATH(kernel.run(), "within one of its processes");
}

}  // namespace
}  // namespace leviosim::sim
