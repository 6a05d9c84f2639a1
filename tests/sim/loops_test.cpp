// Which loops hardware can repeat, against what a programmer counts by hand.
#include "sim/work/loops.h"

#include <gtest/gtest.h>

#include <vector>

#include "sim/work/policy.h"

namespace leviosim::work {
namespace {

using P = Counting;

template <class Body>
Counts counts_of_body(Body body) {
  take_tally();
  body();
  return take_tally();
}

template <class Body>
void repeat(int n, Body body) {
  for ([[maybe_unused]] const int i : P::range(0, n)) body();
}
void nothing() {}

TEST(Loops, TheTwoInnermostOfANestAreFree) {
  EXPECT_EQ(counts_of_body([] { repeat(7, nothing); })[Op::LoopJump], 0u);
  const Counts two = counts_of_body([] { repeat(5, [] { repeat(7, nothing); }); });
  EXPECT_EQ(two[Op::LoopJump], 0u);
  EXPECT_EQ(two[Op::LoopEntry], 1u + 5u);
  EXPECT_EQ(two[Op::LoopIteration], 5u + 35u);
  const auto three = [] { repeat(3, [] { repeat(5, [] { repeat(7, nothing); }); }); };
  EXPECT_EQ(counts_of_body(three)[Op::LoopJump], 3u);
  EXPECT_EQ(counts_of_body([&] { repeat(2, three); })[Op::LoopJump], 2u + 2 * 3u);
}

TEST(Loops, TheDeepestOfSeveralWithinDecides) {
  const Counts counts = counts_of_body([] {
    repeat(3, [] {
      repeat(5, [] { repeat(7, nothing); });
      repeat(11, nothing);
    });
    repeat(13, [] { repeat(17, nothing); });
  });
  EXPECT_EQ(counts[Op::LoopJump], 3u);
}

TEST(Loops, ABranchInsideLeavesNoLoopAroundItToHardware) {
  const I32 x(3);
  const auto branch = [&] {
    if (x < I32(5)) return;
  };
  EXPECT_EQ(counts_of_body([&] { repeat(7, branch); })[Op::LoopJump], 7u);
  EXPECT_EQ(counts_of_body([&] { repeat(5, [&] { repeat(7, branch); }); })[Op::LoopJump], 5u + 35u);
  // … but those beside it.
  const Counts beside = counts_of_body([&] {
    repeat(5, [&] {
      branch();
      repeat(7, nothing);
    });
  });
  EXPECT_EQ(beside[Op::LoopJump], 5u);
}

TEST(Loops, SoDoCallsAndEmulatedArithmetic) {
  const auto call = [] { const P::Function function("of the loops' test"); };
  EXPECT_EQ(counts_of_body([&] { repeat(7, call); })[Op::LoopJump], 7u);
  F64 sum(1.0);
  EXPECT_EQ(counts_of_body([&] { repeat(7, [&] { sum += F64(0.5); }); })[Op::LoopJump], 7u);
  EXPECT_EQ(counts_of_body([&] { repeat(7, [&] { sum *= F64(0.5); }); })[Op::LoopJump], 7u);
  EXPECT_EQ(counts_of_body([&] { repeat(7, [&] { sum /= F64(0.5); }); })[Op::LoopJump], 7u);
  const auto compare = [&] { static_cast<void>(sum < F64(0.5)); };
  EXPECT_EQ(counts_of_body([&] { repeat(7, compare); })[Op::LoopJump], 7u);
  const auto narrow = [&] { static_cast<void>(to_f32(sum)); };
  EXPECT_EQ(counts_of_body([&] { repeat(7, narrow); })[Op::LoopJump], 7u);
  F32 single(1.0F);
  EXPECT_EQ(counts_of_body([&] { repeat(7, [&] { single += F32(0.5F); }); })[Op::LoopJump], 0u);
}

TEST(Loops, CountTheIterationsThatWereMade) {
  const I32 three(3);
  const auto search = [&] {
    for (const int i : P::range(0, 100))
      if (three == I32(i)) break;
  };
  const Counts counts = counts_of_body(search);
  EXPECT_EQ(counts[Op::LoopIteration], 3u);
  EXPECT_EQ(counts[Op::LoopJump], 3u);
  EXPECT_EQ(counts_of_body([] { repeat(0, nothing); })[Op::LoopIteration], 0u);
}

template <class Policy>
std::vector<int> visited(int begin, int last) {
  std::vector<int> all;
  for (const int i : Policy::down_range(begin, last)) all.push_back(i);
  for (const int i : Policy::range(last, begin + 1)) all.push_back(i);
  return all;
}

TEST(Loops, GoUpAndDownUnderBothPolicies) {
  const std::vector<int> expected{4, 3, 2, 2, 3, 4};
  EXPECT_EQ(visited<P>(4, 2), expected);
  EXPECT_EQ(visited<Native>(4, 2), expected);
  EXPECT_TRUE(visited<P>(1, 2).empty());
  const Counts down = counts_of_body([] {
    for ([[maybe_unused]] const int i : P::down_range(9, 0)) nothing();
  });
  EXPECT_EQ(down[Op::LoopEntry], 1u);
  EXPECT_EQ(down[Op::LoopIteration], 10u);
  EXPECT_EQ(down[Op::LoopJump], 0u);
}

TEST(Loops, OfByteCountersCountAsOthers) {
  const auto counted = [](auto range) {
    return counts_of_body([&] {
      for ([[maybe_unused]] const int i : range()) nothing();
    });
  };
  EXPECT_EQ(counted([] { return P::byte_range(3, 255); }),
            counted([] { return P::range(3, 255); }));
  std::vector<int> all;
  for (const int i : Native::byte_range(253, 255)) all.push_back(i);
  EXPECT_EQ(all, (std::vector<int>{253, 254}));
  for (const int i : Native::byte_range(7, 7)) all.push_back(i);
  EXPECT_EQ(all.size(), 2u);
}

TEST(Loops, ACopyInARegisterIsOneInstructionOfCountedScalars) {
  const Counts counts = counts_of_body([] {
    [[maybe_unused]] const F32 x = copied(F32(2.0F));
    [[maybe_unused]] const I32 i = copied(I32(2));
    [[maybe_unused]] const int plain = copied(2);
  });
  EXPECT_EQ(counts[Op::IntAlu], 2u);
  EXPECT_EQ(copied(2.5F), 2.5F);
}

TEST(Loops, AShiftedSumIsOneOperation) {
  std::int32_t up = 0, down = 0, wrapped = 0;
  const Counts counts = counts_of_body([&] {
    up = value(add_shifted(I32(5), I32(6), 2));
    down = value(add_shifted(I32(-5), I32(-6), 2));  // towards minus infinity
    wrapped = value(add_shifted(I32(0x7fffffff), I32(1), 31));
  });
  EXPECT_EQ(up, 2);
  EXPECT_EQ(down, -3);
  EXPECT_EQ(wrapped, -1);
  EXPECT_EQ(counts[Op::IntAddShift], 3u);
  EXPECT_EQ(counts[Op::IntAlu], 0u);
  EXPECT_EQ(add_shifted(-5, -6, 2), -3);
}

}  // namespace
}  // namespace leviosim::work
