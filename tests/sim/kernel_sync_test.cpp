// Event, Barrier, Semaphore, Channel: who continues, when, and in which order.
#include "sim/events/sync.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/events/channel.h"

namespace leviosim::sim {
namespace {

using Trace = std::vector<std::string>;

std::string stamped(const Kernel& kernel, const std::string& what) {
  return what + "@" + std::to_string(kernel.now().ticks);
}

Process wait_for(Kernel& kernel, Event& event, Trace& trace, std::string name) {
  co_await event.wait();
  trace.push_back(stamped(kernel, name));
}

Process notify_at(Kernel& kernel, Event& event, Trace& trace, Time time) {
  co_await kernel.at(time);
  event.notify();
  trace.push_back(stamped(kernel, "notified"));
}

TEST(KernelEvent, WakesAllWaitersLaterInTheInstantInOrderOfArrival) {
  Kernel kernel;
  Event event(kernel, "event");
  Trace trace;
  for (const char* name : {"a", "b", "c"}) kernel.spawn(name, wait_for(kernel, event, trace, name));
  kernel.spawn("n", notify_at(kernel, event, trace, Time{4}));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"notified@4", "a@4", "b@4", "c@4"}));
}

TEST(KernelEvent, DoesNotRemember) {
  Kernel kernel;
  Event event(kernel, "event");
  Trace trace;
  event.notify();
  kernel.spawn("a", wait_for(kernel, event, trace, "a"));
  EXPECT_EQ(kernel.run(), 1U);
  event.notify();  // from outside any process
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a@0"}));
}

Process arrive(Kernel& kernel, Barrier& barrier, Trace& trace, std::string name,
               std::vector<Duration> delays) {
  for (const Duration delay : delays) {
    co_await kernel.delay(delay);
    co_await barrier.arrive();
    trace.push_back(stamped(kernel, name));
  }
}

TEST(KernelBarrier, ReleasesAfterTheLastArrivalAndAgain) {
  Kernel kernel;
  Barrier barrier(kernel, "join", 3, Duration(11));
  Trace trace;
  kernel.spawn("a", arrive(kernel, barrier, trace, "a", {Duration(50), Duration(1)}));
  kernel.spawn("b", arrive(kernel, barrier, trace, "b", {Duration(20), Duration(2)}));
  kernel.spawn("c", arrive(kernel, barrier, trace, "c", {Duration(30), Duration(3)}));
  kernel.run_until(Time{49});
  EXPECT_EQ(barrier.arrived(), 2U);
  kernel.run_until(Time{60});  // one tick before 50 + 11 is too early
  EXPECT_TRUE(trace.empty());
  kernel.run_until(Time{61});
  EXPECT_EQ(trace, (Trace{"b@61", "c@61", "a@61"}));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"b@61", "c@61", "a@61", "a@75", "b@75", "c@75"}));
}

TEST(KernelBarrier, WithoutLatencyReleasesInTheSameInstant) {
  Kernel kernel;
  Barrier barrier(kernel, "join", 2);
  Trace trace;
  kernel.spawn("a", arrive(kernel, barrier, trace, "a", {Duration(5), Duration(0)}));
  kernel.spawn("b", arrive(kernel, barrier, trace, "b", {Duration(9), Duration(0)}));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a@9", "b@9", "a@9", "b@9"}));
}

TEST(KernelBarrier, OfOneTakesItsLatency) {
  Kernel kernel;
  Barrier barrier(kernel, "join", 1, Duration(3));
  Trace trace;
  kernel.spawn("a", arrive(kernel, barrier, trace, "a", {Duration(5), Duration(0)}));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a@8", "a@11"}));
}

Process use(Kernel& kernel, Semaphore& semaphore, Trace& trace, std::string name, Time arrival,
            std::int64_t permits, Duration duration) {
  co_await kernel.at(arrival);
  co_await semaphore.acquire(permits);
  trace.push_back(stamped(kernel, name));
  co_await kernel.delay(duration);
  semaphore.release(permits);
}

TEST(KernelSemaphore, ServesFirstComeFirstServed) {
  Kernel kernel;
  Semaphore semaphore(kernel, "port", 1);
  Trace trace;
  kernel.spawn("c", use(kernel, semaphore, trace, "c", Time{2}, 1, Duration(10)));
  kernel.spawn("a", use(kernel, semaphore, trace, "a", Time{0}, 1, Duration(10)));
  kernel.spawn("b", use(kernel, semaphore, trace, "b", Time{1}, 1, Duration(10)));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a@0", "b@10", "c@20"}));
  kernel.spawn("d", use(kernel, semaphore, trace, "d", Time{30}, 1, Duration(10)));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace.back(), "d@30") << "what was taken has come back";
}

TEST(KernelSemaphore, ALargeRequestIsNotOvertaken) {
  Kernel kernel;
  Semaphore semaphore(kernel, "slots", 4);
  Trace trace;
  kernel.spawn("a", use(kernel, semaphore, trace, "a", Time{0}, 3, Duration(10)));
  kernel.spawn("big", use(kernel, semaphore, trace, "big", Time{1}, 4, Duration(10)));
  kernel.spawn("small", use(kernel, semaphore, trace, "small", Time{2}, 1, Duration(10)));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a@0", "big@10", "small@20"}));
}

TEST(KernelSemaphore, OneReleaseMaySatisfySeveral) {
  Kernel kernel;
  Semaphore semaphore(kernel, "slots", 2);
  Trace trace;
  kernel.spawn("a", use(kernel, semaphore, trace, "a", Time{0}, 2, Duration(10)));
  kernel.spawn("b", use(kernel, semaphore, trace, "b", Time{1}, 1, Duration(10)));
  kernel.spawn("c", use(kernel, semaphore, trace, "c", Time{2}, 1, Duration(10)));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a@0", "b@10", "c@10"}));
}

Process produce(Kernel& kernel, Channel<int>& channel, Trace& trace, int first, int count) {
  for (int value = first; value < first + count; ++value) {
    co_await channel.push(value);
    trace.push_back(stamped(kernel, "put " + std::to_string(value)));
  }
}

Process consume(Kernel& kernel, Channel<int>& channel, Trace& trace, std::string name, int count,
                Duration pause) {
  for (int i = 0; i < count; ++i) {
    co_await kernel.delay(pause);
    const int value = co_await channel.pop();
    trace.push_back(stamped(kernel, name + " " + std::to_string(value)));
  }
}

TEST(KernelChannel, AProducerWaitsWhileItIsFull) {
  Kernel kernel;
  Channel<int> channel(kernel, "fifo", 2);
  Trace trace;
  kernel.spawn("p", produce(kernel, channel, trace, 1, 4));
  kernel.spawn("c", consume(kernel, channel, trace, "got", 4, Duration(10)));
  kernel.run_until(Time{9});
  EXPECT_EQ(trace, (Trace{"put 1@0", "put 2@0"}));
  EXPECT_EQ(channel.size(), 2U);
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"put 1@0", "put 2@0", "got 1@10", "put 3@10", "got 2@20", "put 4@20",
                          "got 3@30", "got 4@40"}));
}

/// @param left  what can be taken right after
Process produce_two(Kernel& kernel, Channel<int>& channel, std::optional<int>& left) {
  co_await kernel.at(Time{5});
  co_await channel.push(7);
  co_await channel.push(8);
  left = channel.try_pop();
}

TEST(KernelChannel, ConsumersAreServedInOrderOfArrival) {
  Kernel kernel;
  Channel<int> channel(kernel, "fifo", 8);
  Trace trace;
  kernel.spawn("c1", consume(kernel, channel, trace, "first", 1, Duration(1)));
  kernel.spawn("c2", consume(kernel, channel, trace, "second", 1, Duration(2)));
  std::optional<int> left = 0;
  kernel.spawn("p", produce_two(kernel, channel, left));
  EXPECT_EQ(kernel.run(), 0U);
  // Both values are promised to those who wait: nobody can take them in between.
  EXPECT_EQ(left, std::nullopt);
  EXPECT_EQ(trace, (Trace{"first 7@5", "second 8@5"}));
}

TEST(KernelChannel, ProducersThatWaitAreServedInOrderOfArrival) {
  Kernel kernel;
  Channel<int> mailbox(kernel, "mailbox", 1);
  Trace trace;
  kernel.spawn("p1", produce(kernel, mailbox, trace, 10, 2));
  kernel.spawn("p2", produce(kernel, mailbox, trace, 20, 2));
  kernel.run();
  EXPECT_EQ(mailbox.try_pop(), 10);
  EXPECT_EQ(mailbox.size(), 1U);  // the room belongs to who waited for it
  kernel.run();
  std::vector<int> rest;
  while (const std::optional<int> value = mailbox.try_pop()) {
    rest.push_back(*value);
    kernel.run();
  }
  EXPECT_EQ(rest, (std::vector<int>{11, 20, 21}));
}

Process send_owned(Channel<std::unique_ptr<int>>& channel) {
  for (int value = 0; value < 3; ++value) co_await channel.push(std::make_unique<int>(value));
}

Process add_owned(Channel<std::unique_ptr<int>>& channel, int& total) {
  for (int i = 0; i < 3; ++i) total += 1 + *co_await channel.pop();
}

TEST(KernelChannel, ValuesMayBeMoveOnly) {
  Kernel kernel;
  Channel<std::unique_ptr<int>> channel(kernel, "channel", 1);
  int total = 0;
  kernel.spawn("p", send_owned(channel));
  kernel.spawn("c", add_owned(channel, total));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(total, 6);
}

}  // namespace
}  // namespace leviosim::sim
