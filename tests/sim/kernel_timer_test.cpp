// Timers: armed again, cancelled, and used as the ends of segments that share a resource.
#include "sim/events/timer.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "sim/events/task.h"

namespace leviosim::sim {
namespace {

Process note_expiries(Kernel& kernel, Timer& timer, std::vector<Time>& expiries) {
  for (;;) {
    co_await timer.expired();
    expiries.push_back(kernel.now());
  }
}

class KernelTimer : public ::testing::Test {
 protected:
  KernelTimer() { kernel.spawn_server("waiter", note_expiries(kernel, timer, expiries)); }

  Kernel kernel;
  Timer timer{kernel, "timer"};
  std::vector<Time> expiries;
};

TEST_F(KernelTimer, OneTickEarlierIsTooEarly) {
  timer.arm(Time{100});
  EXPECT_TRUE(timer.armed());
  kernel.run_until(Time{99});
  EXPECT_TRUE(expiries.empty());
  kernel.run_until(Time{100});
  EXPECT_EQ(expiries, (std::vector<Time>{Time{100}}));
  EXPECT_FALSE(timer.armed());
}

TEST_F(KernelTimer, ArmedLaterExpiresOnlyThen) {
  timer.arm(Time{100});
  kernel.run_until(Time{50});
  timer.arm(Time{120});
  kernel.run_until(Time{119});
  EXPECT_TRUE(expiries.empty());
  kernel.run();
  EXPECT_EQ(expiries, (std::vector<Time>{Time{120}}));
}

TEST_F(KernelTimer, ArmedEarlierExpiresOnlyThen) {
  timer.arm(Time{100});
  kernel.run_until(Time{50});
  timer.arm(Time{60});
  kernel.run_until(Time{59});
  EXPECT_TRUE(expiries.empty());
  kernel.run();
  EXPECT_EQ(expiries, (std::vector<Time>{Time{60}}));
  EXPECT_EQ(kernel.now(), Time{60});  // nothing was left at 100
}

TEST_F(KernelTimer, CancelledDoesNotExpireUntilArmedAgain) {
  timer.arm(Time{100});
  kernel.run_until(Time{99});
  timer.cancel();
  EXPECT_FALSE(timer.armed());
  kernel.run_until(Time{200});
  EXPECT_TRUE(expiries.empty());
  timer.cancel();
  timer.arm(Time{300});
  kernel.run();
  EXPECT_EQ(expiries, (std::vector<Time>{Time{300}}));
}

TEST_F(KernelTimer, ExpiresAgainAndAgain) {
  for (const std::int64_t time : {10, 20, 30}) {
    timer.arm(Time{time});
    kernel.run();
  }
  EXPECT_EQ(expiries, (std::vector<Time>{Time{10}, Time{20}, Time{30}}));
}

TEST_F(KernelTimer, SaysWhatItsWaiterIsBlockedBy) {
  kernel.run();
  ASSERT_EQ(kernel.blocked().size(), 1U);
  EXPECT_EQ(kernel.blocked()[0].waits_for, "timer");
  timer.arm(Time{100});
  EXPECT_TRUE(kernel.blocked().empty());
  timer.cancel();
  EXPECT_EQ(kernel.blocked().size(), 1U);
}

Process expect_expiry(Kernel& kernel, Timer& timer, Time& continued) {
  co_await kernel.at(Time{50});
  co_await timer.expired();
  continued = kernel.now();
  co_await timer.expired();
  continued = Time::max();
}

TEST(KernelTimerAlone, AnExpiryIsRememberedOnce) {
  Kernel kernel;
  Timer timer(kernel, "timer");
  Time continued;
  timer.arm(Time{10});
  kernel.spawn("p", expect_expiry(kernel, timer, continued));
  EXPECT_EQ(kernel.run(), 1U);
  EXPECT_EQ(continued, Time{50});
}

TEST(KernelTimerAlone, ArmingForgetsAnExpiry) {
  Kernel kernel;
  Timer timer(kernel, "timer");
  Time continued;
  timer.arm(Time{10});
  kernel.spawn("p", expect_expiry(kernel, timer, continued));
  kernel.run_until(Time{20});
  timer.arm(Time{70});
  EXPECT_EQ(kernel.run(), 1U);
  EXPECT_EQ(continued, Time{70});
}

TEST(KernelTimerAlone, MayBeDestroyedWhileArmedOrAwaited) {
  Kernel kernel;
  std::vector<Time> expiries;
  {
    Timer timer(kernel, "timer");
    kernel.spawn("waiter", note_expiries(kernel, timer, expiries));
    kernel.run();
    timer.arm(Time{100});
  }
  EXPECT_EQ(kernel.run(), 1U);
  EXPECT_TRUE(expiries.empty());
  EXPECT_EQ(kernel.blocked()[0].waits_for, kDestroyed);
}

/// Segments that share one processor equally: each proceeds at 1 / (number running). The rates are
/// solved once per instant, after everything that starts or ends in it.
class SharedProcessor {
 public:
  explicit SharedProcessor(Kernel& kernel) : kernel_(kernel), changed_(kernel, "changed") {
    kernel.spawn_server("solver", solve());
  }

  Task<> execute(std::int64_t work) {
    Segment segment{Timer(kernel_, "segment end"), work};
    running_.push_back(&segment);
    changed_.arm(kernel_.now(), Phase::Settle);
    co_await segment.end.expired();
    std::erase(running_, &segment);
    changed_.arm(kernel_.now(), Phase::Settle);
  }
  int solutions() const { return solutions_; }

 private:
  struct Segment {
    Timer end;
    std::int64_t left;  // work, kept exact: all numbers of the tests divide
  };

  Process solve() {
    for (std::size_t sharers = 0;;) {
      co_await changed_.expired();
      const std::int64_t elapsed = (kernel_.now() - since_).count();
      since_ = kernel_.now();
      const auto share = static_cast<std::int64_t>(running_.size());
      for (Segment* segment : running_) {
        if (segment->end.armed()) segment->left -= elapsed / static_cast<std::int64_t>(sharers);
        segment->end.arm(kernel_.now() + Duration(segment->left * share));
      }
      sharers = running_.size();
      ++solutions_;
    }
  }

  Kernel& kernel_;
  Timer changed_;
  std::vector<Segment*> running_;
  Time since_;
  int solutions_ = 0;
};

Process run_segment(Kernel& kernel, SharedProcessor& processor, Time start, std::int64_t work,
                    Time& end) {
  co_await kernel.at(start);
  co_await processor.execute(work);
  end = kernel.now();
}

TEST(KernelTimerAlone, SharedResourceAgreesWithTheClosedForm) {
  Kernel kernel;
  SharedProcessor processor(kernel);
  Time a;
  Time b;
  Time c;
  // a alone in [0, 60), a and b share [60, 120): a has 30 left. c joins at 120 with 30: all three
  // share until a and c end at 210, both done; b has then 90 left and ends at 300.
  kernel.spawn("a", run_segment(kernel, processor, Time{0}, 120, a));
  kernel.spawn("b", run_segment(kernel, processor, Time{60}, 150, b));
  kernel.spawn("c", run_segment(kernel, processor, Time{120}, 30, c));
  kernel.run_until(Time{209});
  EXPECT_EQ(a, Time{});
  EXPECT_EQ(kernel.run(), 0U);
  EXPECT_EQ(a, Time{210});
  EXPECT_EQ(c, Time{210});
  EXPECT_EQ(b, Time{300});
  EXPECT_EQ(processor.solutions(), 5);  // at 0, 60, 120, once for both ends at 210, at 300
}

}  // namespace
}  // namespace leviosim::sim
