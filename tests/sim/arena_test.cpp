// Where blocks of modelled memory end, what is missing if one does not fit, and the peak.
#include "sim/work/arena.h"

#include <gtest/gtest.h>

#include "sim/work/policy.h"
#include "tests/traces/test_folder.h"

namespace leviosim::work {
namespace {

using Byte = Native::Span<std::uint8_t>;

TEST(Arena, HoldsWhatFitsExactlyAndNotAByteMore) {
  Arena arena("L1", Bytes(100), 1);
  arena.alloc<Byte>("first", 60);
  arena.alloc<Byte>("second", 40);
  EXPECT_EQ(arena.used(), Bytes(100));
  traces::testing::expect_input_error(
      [&] { arena.alloc<Byte>("third", 1); },
      {"'third'", "1 bytes", "L1", "100 of 100", "1 bytes are missing"});
}

TEST(Arena, BlocksBeginAtMultiplesOfTheAlignment) {
  Arena arena("L2", Bytes(100), 8);
  arena.alloc<Byte>("first", 3);
  arena.alloc<Byte>("second", 3);
  EXPECT_EQ(arena.used(), Bytes(11));
  ASSERT_EQ(arena.live().size(), 2u);
  EXPECT_EQ(arena.live()[1].offset, Bytes(8));
}

TEST(Arena, ThePeakIsThatOfTheBlocksAliveTogether) {
  Arena arena("L1", Bytes(100), 1);
  {
    const Arena::Frame frame(arena);
    arena.alloc<Byte>("short", 50);
  }
  arena.alloc<Byte>("long", 30);
  EXPECT_EQ(arena.used(), Bytes(30));
  EXPECT_EQ(arena.peak(), Bytes(50));
  ASSERT_EQ(arena.blocks_at_peak().size(), 1u);
  EXPECT_EQ(arena.blocks_at_peak()[0].name, "short");
}

}  // namespace
}  // namespace leviosim::work
