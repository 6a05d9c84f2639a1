// Processes composed of sub-coroutines: values, exceptions, time, depth.
#include "sim/events/task.h"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/events/kernel.h"

namespace leviosim::sim {
namespace {

Task<int> immediate(int value) { co_return value; }

Task<int> after(Kernel& kernel, Duration duration, int value) {
  co_await kernel.delay(duration);
  co_return value;
}

Task<int> sum(Kernel& kernel) {
  const int a = co_await after(kernel, Duration(10), 1);
  const int b = co_await immediate(2);
  const int c = co_await after(kernel, Duration(5), 4);
  co_return a + b + c;
}

Process store_sum(Kernel& kernel, int& result) { result = co_await sum(kernel); }

TEST(KernelTask, ValuesComeBackAndTimeAddsUp) {
  Kernel kernel;
  int result = 0;
  kernel.spawn("p", store_sum(kernel, result));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(result, 7);
  EXPECT_EQ(kernel.now(), Time{15});
  EXPECT_EQ(kernel.events_executed(), 3U);  // the start and two delays: tasks cost no events
}

Task<> set(bool& flag) {
  flag = true;
  co_return;
}

Process start_late(Kernel& kernel, bool& flag, bool& early) {
  Task<> task = set(flag);
  co_await kernel.delay(Duration(1));
  early = flag;
  co_await std::move(task);
}

TEST(KernelTask, StartsWhenAwaited) {
  Kernel kernel;
  bool flag = false;
  bool early = true;
  kernel.spawn("p", start_late(kernel, flag, early));
  kernel.run();
  EXPECT_FALSE(early);
  EXPECT_TRUE(flag);
}

Task<std::unique_ptr<std::string>> make_text(Kernel& kernel) {
  co_await kernel.delay(Duration(1));
  co_return std::make_unique<std::string>("text");
}

Process store_text(Kernel& kernel, std::string& text) {
  const std::unique_ptr<std::string> made = co_await make_text(kernel);
  text = *made;
}

TEST(KernelTask, ResultsMayBeMoveOnly) {
  Kernel kernel;
  std::string text;
  kernel.spawn("p", store_text(kernel, text));
  kernel.run();
  EXPECT_EQ(text, "text");
}

Task<int> fail(Kernel& kernel, Duration duration) {
  if (duration > Duration(0)) co_await kernel.delay(duration);
  throw std::runtime_error("failed at " + std::to_string(kernel.now().ticks));
}

Task<int> pass_on(Kernel& kernel, Duration duration) { co_return co_await fail(kernel, duration); }

Process catch_both(Kernel& kernel, std::vector<std::string>& caught) {
  for (const Duration duration : {Duration(0), Duration(7)}) {
    std::string message;
    try {
      co_await pass_on(kernel, duration);
    } catch (const std::runtime_error& error) {
      message = error.what();
    }
    co_await kernel.delay(Duration(1));
    caught.push_back(message);
  }
}

TEST(KernelTask, ExceptionsReachTheCaller) {
  Kernel kernel;
  std::vector<std::string> caught;
  kernel.spawn("p", catch_both(kernel, caught));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(caught, (std::vector<std::string>{"failed at 0", "failed at 8"}));
}

Process fail_in_task(Kernel& kernel) { co_await pass_on(kernel, Duration(3)); }

Process count(Kernel& kernel, int& ticks) {
  for (; ticks < 10; ++ticks) co_await kernel.delay(Duration(1));
}

TEST(KernelTask, ExceptionsNobodyCatchesLeaveRun) {
  Kernel kernel;
  int ticks = 0;
  kernel.spawn("failing", fail_in_task(kernel));
  kernel.spawn("counting", count(kernel, ticks));
  try {
    kernel.run();
    FAIL() << "nothing thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "failed at 3");
  }
  EXPECT_EQ(kernel.now(), Time{3});
  EXPECT_LT(ticks, 10);
  EXPECT_EQ(kernel.run(), 0U);  // the others are as they were
  EXPECT_EQ(ticks, 10);
}

Process await_many(int times, long& total) {
  for (int i = 0; i < times; ++i) total += co_await immediate(1);
}

TEST(KernelTask, AMillionTasksThatNeverWaitNeedNoStack) {
  Kernel kernel;
  long total = 0;
  kernel.spawn("p", await_many(1'000'000, total));
  kernel.run();
  EXPECT_EQ(total, 1'000'000);
}

Process await_waiting(Kernel& kernel, int times, long& total) {
  for (int i = 0; i < times; ++i) total += co_await after(kernel, Duration(1), 1);
}

TEST(KernelTask, NorDoManyThatWait) {
  Kernel kernel;
  long total = 0;
  kernel.spawn("p", await_waiting(kernel, 200'000, total));
  kernel.run();
  EXPECT_EQ(total, 200'000);
  EXPECT_EQ(kernel.now(), Time{200'000});
}

Task<int> depth(Kernel& kernel, int levels) {
  if (levels == 0) co_return co_await after(kernel, Duration(1), 0);
  co_return 1 + co_await depth(kernel, levels - 1);
}

Process store_depth(Kernel& kernel, int& result) { result = co_await depth(kernel, 500); }

TEST(KernelTask, TasksNest) {
  Kernel kernel;
  int result = 0;
  kernel.spawn("p", store_depth(kernel, result));
  kernel.run();
  EXPECT_EQ(result, 500);
}

}  // namespace
}  // namespace leviosim::sim
