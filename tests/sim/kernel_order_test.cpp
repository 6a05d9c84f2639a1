// The order of events: (time, phase, sequence), the same in every run.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/events/channel.h"
#include "sim/events/kernel.h"
#include "sim/events/sync.h"
#include "sim/events/timer.h"

namespace leviosim::sim {
namespace {

using Trace = std::vector<std::string>;

Process note_at(Kernel& kernel, Trace& trace, std::string name, Time time, Phase phase) {
  co_await kernel.at(time, phase);
  trace.push_back(std::move(name));
}

TEST(KernelOrder, TimeFirst) {
  Kernel kernel;
  Trace trace;
  kernel.spawn("c", note_at(kernel, trace, "c", Time{30}, Phase::Run));
  kernel.spawn("a", note_at(kernel, trace, "a", Time{10}, Phase::Observe));
  kernel.spawn("b", note_at(kernel, trace, "b", Time{20}, Phase::Wake));
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(trace, (Trace{"a", "b", "c"}));
  EXPECT_EQ(kernel.now(), Time{30});
}

TEST(KernelOrder, ThenPhase) {
  Kernel kernel;
  Trace trace;
  kernel.spawn("o", note_at(kernel, trace, "observe", Time{5}, Phase::Observe));
  kernel.spawn("s", note_at(kernel, trace, "settle", Time{5}, Phase::Settle));
  kernel.spawn("w", note_at(kernel, trace, "wake", Time{5}, Phase::Wake));
  kernel.spawn("r", note_at(kernel, trace, "run", Time{5}, Phase::Run));
  kernel.run();
  EXPECT_EQ(trace, (Trace{"run", "wake", "settle", "observe"}));
}

TEST(KernelOrder, ThenSequence) {
  Kernel kernel;
  Trace trace;
  for (const char* name : {"1", "2", "3", "4", "5"})
    kernel.spawn(name, note_at(kernel, trace, name, Time{5}, Phase::Run));
  kernel.run();
  EXPECT_EQ(trace, (Trace{"1", "2", "3", "4", "5"}));
}

TEST(KernelOrder, AgreesWithAStableSort) {
  using Row = std::tuple<Time, Phase, int>;
  std::vector<Row> rows;
  std::uint32_t state = 12345;
  for (int i = 0; i < 500; ++i) {
    state = state * 1664525U + 1013904223U;
    rows.emplace_back(Time{1 + (state >> 16) % 37}, static_cast<Phase>((state >> 24) % 4), i);
  }
  Kernel kernel;
  Trace trace;
  for (const auto& [time, phase, index] : rows)
    kernel.spawn("p", note_at(kernel, trace, std::to_string(index), time, phase));
  kernel.run();

  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return std::pair(std::get<0>(a), std::get<1>(a)) < std::pair(std::get<0>(b), std::get<1>(b));
  });
  Trace expected;
  for (const Row& row : rows) expected.push_back(std::to_string(std::get<2>(row)));
  EXPECT_EQ(trace, expected);
}

Process observe_then_run_again(Kernel& kernel, Trace& trace) {
  co_await kernel.at(Time{5}, Phase::Observe);
  trace.push_back("observe");
  co_await kernel.delay(Duration(0), Phase::Run);
  trace.push_back("run again");
}

TEST(KernelOrder, AnEarlierPhaseOfTheSameInstantComesNext) {
  Kernel kernel;
  Trace trace;
  kernel.spawn("a", observe_then_run_again(kernel, trace));
  kernel.spawn("b", note_at(kernel, trace, "other observer", Time{5}, Phase::Observe));
  kernel.run();
  EXPECT_EQ(trace, (Trace{"observe", "run again", "other observer"}));
}

Process yield(Kernel& kernel, Trace& trace, std::string name) {
  trace.push_back(name + "1");
  co_await kernel.delay(Duration(0));
  trace.push_back(name + "2");
}

TEST(KernelOrder, ADelayOfZeroLetsOthersRun) {
  Kernel kernel;
  Trace trace;
  kernel.spawn("a", yield(kernel, trace, "a"));
  kernel.spawn("b", yield(kernel, trace, "b"));
  kernel.run();
  EXPECT_EQ(trace, (Trace{"a1", "b1", "a2", "b2"}));
}

Process arm_now(Kernel& kernel, Timer& timer, Trace& trace) {
  timer.arm(kernel.now());
  co_await kernel.delay(Duration(0));
  trace.push_back("delayed");
}

Process await_timer(Timer& timer, Trace& trace) {
  co_await timer.expired();
  trace.push_back("timer");
}

TEST(KernelOrder, TimersAndDelaysShareOneSequence) {
  Kernel kernel;
  Trace trace;
  Timer timer(kernel, "timer");
  kernel.spawn("wait", await_timer(timer, trace));
  kernel.spawn("arm", arm_now(kernel, timer, trace));
  kernel.spawn("late", note_at(kernel, trace, "late", Time{0}, Phase::Run));
  kernel.run();
  EXPECT_EQ(trace, (Trace{"timer", "delayed", "late"}));
}

Process tick(Kernel& kernel, Trace& trace) {
  for (;;) {
    co_await kernel.delay(Duration(10));
    trace.push_back(std::to_string(kernel.now().ticks));
  }
}

TEST(KernelOrder, RunUntilIncludesItsEndAndNothingLater) {
  Kernel kernel;
  Trace trace;
  kernel.spawn("tick", tick(kernel, trace));
  kernel.run_until(Time{19});
  EXPECT_EQ(trace, (Trace{"10"}));
  EXPECT_EQ(kernel.now(), Time{19});
  kernel.run_until(Time{20});
  EXPECT_EQ(trace, (Trace{"10", "20"}));
  kernel.run_until(Time{20});
  kernel.run_until(Time{45});
  EXPECT_EQ(trace, (Trace{"10", "20", "30", "40"}));
  EXPECT_TRUE(kernel.blocked().empty());
}

/// A network that uses everything at once.
struct Busy {
  explicit Busy(Trace& t) : trace(t) {
    for (int id = 0; id < 5; ++id) kernel.spawn("worker", worker(id));
    kernel.spawn("consumer", consumer());
  }
  void note(const std::string& what) {
    trace.push_back(std::to_string(kernel.now().ticks) + " " + what);
  }
  Process worker(int id) {
    for (int i = 0; i < 20; ++i) {
      co_await permits.acquire(1 + id % 2);
      co_await kernel.delay(Duration((id * 7 + i * 3) % 5));
      permits.release(1 + id % 2);
      note("worker " + std::to_string(id));
      co_await channel.push(id);
      co_await barrier.arrive();
    }
  }
  Process consumer() {
    for (int i = 0; i < 100; ++i) note("got " + std::to_string(co_await channel.pop()));
  }

  Trace& trace;
  Kernel kernel;
  Semaphore permits{kernel, "permits", 3};
  Barrier barrier{kernel, "barrier", 5, Duration(2)};
  Channel<int> channel{kernel, "channel", 2};
};

TEST(KernelOrder, TheSameRunTwiceGivesTheSameTrace) {
  Trace first;
  Trace second;
  EXPECT_EQ(Busy(first).kernel.run(), 0U);
  EXPECT_EQ(Busy(second).kernel.run(), 0U);
  EXPECT_EQ(first.size(), 200U);
  EXPECT_EQ(first, second);
}

TEST(KernelOrder, RunningInSlicesGivesTheSameTrace) {
  Trace whole;
  Trace sliced;
  Busy(whole).kernel.run();
  Busy busy(sliced);
  for (std::int64_t end = 0; end < 400; ++end) busy.kernel.run_until(Time{end});
  EXPECT_EQ(whole, sliced);
}

Process go_back(Kernel& kernel) {
  co_await kernel.delay(Duration(10));
  co_await kernel.at(Time{9});
}

Process wait_negative(Kernel& kernel) { co_await kernel.delay(Duration(-1)); }

TEST(KernelOrderDeathTest, ThePastIsAnInternalFault) {
  Kernel kernel;
  kernel.spawn("back", go_back(kernel));
  EXPECT_DEATH(kernel.run(), "in the past");
  Kernel other;
  other.spawn("negative", wait_negative(other));
  EXPECT_DEATH(other.run(), "negative");
}

}  // namespace
}  // namespace leviosim::sim
