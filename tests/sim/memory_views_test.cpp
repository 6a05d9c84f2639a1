// Views of memory: what an index says about the address, and what is no index.
#include <gtest/gtest.h>

#include "sim/work/policy.h"

namespace leviosim::work {
namespace {

template <class View, class Index>
concept Indexable = requires(const View view, Index i) {
  view[i];
};
template <class View, class Offset>
concept Dividable = requires(const View view, Offset i) {
  view.subspan(i, 1);
};

using View = Counting::Span<F32>;
using Array = Counting::Array<F32, 4>;
using Plain = decltype(value(I32(0)));

// The plain value of data would count as an index of a loop.
static_assert(Indexable<View, int> && Indexable<View, I32> && !Indexable<View, Plain>);
static_assert(Dividable<View, int> && Dividable<View, I32> && !Dividable<View, Plain>);
static_assert(Indexable<Array, int> && Indexable<Array, I32> && !Indexable<Array, Plain>);
static_assert(Indexable<Counting::L2Span<F32>, I32> && !Indexable<Counting::L2Span<F32>, Plain>);
// Natively both are integers.
static_assert(Indexable<Native::Span<float>, decltype(value(Native::I32(0)))>);

TEST(MemoryViews, CountAnIndexByWhereItComesFrom) {
  F32 cells[4] = {0.0f, 1.0f, 2.0f, 3.0f};
  const View view(cells, 4);
  take_tally();
  EXPECT_EQ(value(F32(view[2])), 2.0f);
  EXPECT_EQ(value(F32(view[I32(3)])), 3.0f);
  const Counts counts = take_tally();
  EXPECT_EQ(counts[Op::LoadStream], 1u);
  EXPECT_EQ(counts[Op::LoadIndexed], 1u);
}

TEST(MemoryViews, AreStreamsFromAComputedPlaceOn) {
  F32 cells[4] = {0.0f, 1.0f, 2.0f, 3.0f};
  const View view(cells, 4);
  take_tally();
  const View run = view.subspan(I32(I32(1) * I32(2)), 2);
  EXPECT_EQ(value(F32(run[0])) + value(F32(run[1])), 5.0f);
  const Counts counts = take_tally();
  EXPECT_EQ(counts[Op::IntMul], 1u);
  EXPECT_EQ(counts[Op::LoadStream], 2u);
  EXPECT_EQ(counts[Op::LoadIndexed], 0u);
}

// A list that may lie in either memory costs what it costs where it is.
TEST(MemoryViews, OfEitherMemoryCountWhereTheyLie) {
  F32 cells[4] = {0.0f, 1.0f, 2.0f, 3.0f};
  const Counting::EitherSpan<F32> local = View(cells, 4), far = local.in_l2();
  const auto use = [](const Counting::EitherSpan<F32>& view) {
    take_tally();
    view[0] = F32(view[1]) + F32(view[I32(3)]);
    view[I32(2)] = 1.0f;
    const Counting::EitherSpan<const F32> part = view.subspan(1, 2);
    EXPECT_EQ(value(F32(part[1])), 1.0f);
    return take_tally();
  };
  const Counts near = use(local), there = use(far);
  EXPECT_EQ(near[Op::LoadStream], 2u);
  EXPECT_EQ(near[Op::LoadIndexed], 1u);
  EXPECT_EQ(near[Op::StoreStream], 1u);
  EXPECT_EQ(near[Op::StoreIndexed], 1u);
  EXPECT_EQ(near[Op::LoadL2] + near[Op::StoreL2], 0u);
  EXPECT_EQ(there[Op::LoadL2], 3u);
  EXPECT_EQ(there[Op::StoreL2], 2u);
  EXPECT_EQ(there[Op::LoadStream] + there[Op::LoadIndexed] + there[Op::StoreStream] +
                there[Op::StoreIndexed],
            0u);
}

TEST(MemoryViews, ThePlainValueOfAnIntegerIsAnInt) {
  const int n = value(I32(7));
  EXPECT_EQ(n, 7);
  EXPECT_EQ(value(I32(7)) + 1, 8);
}

}  // namespace
}  // namespace leviosim::work
