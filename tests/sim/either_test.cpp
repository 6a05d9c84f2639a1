// Blocks that lie in local memory, or behind it where they leave too little.
#include "sim/work/either.h"

#include <gtest/gtest.h>

namespace leviosim::work {
namespace {

using P = Counting;

bool lies_behind(P::EitherSpan<P::U32> view) {
  take_tally();
  static_cast<void>(value(P::U32(view[0])));
  return take_tally()[Op::LoadL2] == 1;
}

TEST(Either, KeepsOfLocalMemoryWhatItWasTold) {
  Machine machine({.cores = 1, .capacity = Bytes(1000)});
  machine.set_behind(Arena("L2", Bytes(2000)), Bytes(400));
  const EitherFrame frame(machine);
  EXPECT_FALSE(lies_behind(alloc_either<P, P::U32>(machine, "a", 150)));  // leaves exactly 400
  {
    const EitherFrame inner(machine);
    EXPECT_TRUE(lies_behind(alloc_either<P, P::U32>(machine, "b", 1)));
    EXPECT_EQ(machine.local().used(), Bytes(600));
    EXPECT_EQ(machine.behind().used(), Bytes(4));
  }
  EXPECT_EQ(machine.behind().used(), Bytes(0));
}

TEST(Either, IsLocalMemoryWhereNothingLiesBehind) {
  Machine machine({.cores = 1, .capacity = Bytes(1000)});
  EXPECT_FALSE(lies_behind(alloc_either<P, P::U32>(machine, "a", 250)));
  EXPECT_THROW((alloc_either<P, P::U32>(machine, "b", 1)), MemoryOverflow);
}

}  // namespace
}  // namespace leviosim::work
