// Blocks that pass through local memory in tiles, against closed formulas.
#include "sim/work/tiles.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sim/chip/chip.h"
#include "sim/work/transfers.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::work {
namespace {

using P = Counting;
using Words = P::Span<P::U32>;

TEST(TilePlan, CoversAllItemsOnceAndHasThoseAround) {
  for (const int each : {1, 7, 16, 100, 500}) {
    const TilePlan plan(16, 104, each, 4, 106);
    int next = 16;
    for (int i = 0; i < plan.count(); ++i) {
      const Tile tile = plan[i];
      EXPECT_EQ(tile.begin, next);
      EXPECT_EQ(tile.first, tile.begin - 4);
      EXPECT_EQ(tile.last, std::min(106, tile.end + 4));
      EXPECT_LE(tile.items(), plan.most_items());
      next = tile.end;
    }
    EXPECT_EQ(next, 104);
  }
}

TEST(TilePlan, IsOfTheFewestTilesOfWhichTwoFit) {
  const Arena arena("L1", Bytes(1000));
  for (const int n : {1, 4, 5, 31, 100, 1000}) {
    const TilePlan plan = plan_tiles(arena, "b", n, Bytes(32), Bytes(100));
    EXPECT_LE(2 * 32 * plan.most_items(), 900) << n;
    const int most = 900 / 2 / 32;
    EXPECT_EQ(plan.count(), (n + most - 1) / most) << n;
  }
  EXPECT_EQ(plan_tiles(arena, "b", 0, Bytes(32)).count(), 0);
}

TEST(TilePlan, OfWhichNotOneItemFitsIsRefusedWithStageAndBlock) {
  Arena arena("L1", Bytes(1000));
  arena.set_user("matching");
  try {
    plan_tiles(arena, "descriptors", 5, Bytes(32), Bytes(950));
    FAIL() << "accepted";
  } catch (const MemoryOverflow& error) {
    EXPECT_STREQ(error.what(),
                 "matching: block 'descriptors' of 1014 bytes does not fit in L1: 0 of 1000 bytes "
                 "are in use, 14 bytes are missing");
  }
}

/// `n` words pass in tiles of `each` and come back with one added to each.
struct Passed {
  std::vector<P::U32> result;
  Job job;
  std::vector<Passage> passages;
};

Passed add_one_to_all(int n, int each, int work_per_word = 0) {
  Machine machine({.cores = 1, .capacity = Bytes(64 * 1024), .record = true});
  std::vector<P::U32> words(static_cast<std::size_t>(n));
  std::iota(words.begin(), words.end(), 0u);
  Passed passed{std::vector<P::U32>(words.size()), {}, {}};
  {
    const auto stage = machine.stage("s");
    const Arena::Frame frame(machine.local());
    TilesOut<P, P::U32> out(machine, "out", each);
    for_each_tile<P>(
        machine, TilePlan(0, n, each, 0, n),
        [&](int, const Tile& tile, Words in) {
          const Words to = out.next(machine);
          for (int i : P::range(0, tile.size())) {
            P::U32 word = in[i];
            for ([[maybe_unused]] int k : P::range(0, work_per_word)) word = word ^ P::U32(0u);
            to[i] = word + P::U32(1u);
          }
          out.send(machine, Words(passed.result.data() + tile.begin, tile.size()));
        },
        PassingBlock<P, P::U32>{"in", Words(words.data(), n)});
    out.finish(machine);
  }
  passed.job = machine.take_job();
  passed.passages = machine.passages();
  return passed;
}

TEST(Tiles, GoThereAndBackAndEveryItemOnce) {
  for (const int each : {1, 3, 8, 99, 100, 200}) {
    const Passed passed = add_one_to_all(100, each);
    for (std::size_t i = 0; i < passed.result.size(); ++i)
      ASSERT_EQ(value(passed.result[i]), i + 1) << each;
    Bytes in{0}, out{0};
    for (const Step& step : passed.job.stages.at(0).steps)
      if (const auto* transfer = std::get_if<Transfer>(&step))
        (transfer->direction == Direction::L2ToL1 ? in : out) += transfer->bytes;
    EXPECT_EQ(in, Bytes(400));
    EXPECT_EQ(out, Bytes(400));
    ASSERT_EQ(passed.passages.size(), 2u);
    EXPECT_EQ(passed.passages[0].block, "in");
    EXPECT_EQ(passed.passages[0].stage, "s");
    EXPECT_EQ(passed.passages[0].tiles, (100 + each - 1) / each);
    EXPECT_EQ(passed.passages[0].bytes, Bytes(400));
    EXPECT_EQ(passed.passages[1].block, "out");
  }
}

/// `n` words come in tiles of 10, and of every third tile nothing goes back.
Job keep_two_thirds(int n, int buffers) {
  Machine machine({.cores = 1, .capacity = Bytes(64 * 1024), .record = true});
  std::vector<P::U32> words(static_cast<std::size_t>(n)), kept(words.size());
  std::iota(words.begin(), words.end(), 0u);
  int total = 0;
  {
    const auto stage = machine.stage("s");
    const Arena::Frame frame(machine.local());
    TilesOut<P, P::U32> out(machine, "out", 10, false, buffers);
    for_each_tile<P>(
        machine, TilePlan(0, n, 10, 0, n, buffers),
        [&](int i, const Tile& tile, Words in) {
          const Words to = out.next(machine);
          if (i % 3 == 2) return;
          for (int k : P::range(0, tile.size())) to[k] = P::U32(in[k]);
          out.send(machine, Words(kept.data() + total, tile.size()));
          total += tile.size();
        },
        PassingBlock<P, P::U32>{"in", Words(words.data(), n)});
    out.finish(machine);
  }
  for (int i = 0, at = 0; i < n; ++i) {
    if (i / 10 % 3 == 2) continue;
    EXPECT_EQ(value(kept[static_cast<std::size_t>(at++)]), static_cast<std::uint32_t>(i));
  }
  return machine.take_job();  // which checks that every transfer has been waited for once
}

TEST(Tiles, OfWhichSomeAreNotSentAreWaitedForOnce) {
  for (const int n : {1, 20, 21, 100, 205}) keep_two_thirds(n, 2);
}

TEST(Tiles, PassOneAtATimeThroughOneBuffer) {
  for (const int n : {1, 20, 100}) {
    const Job two = keep_two_thirds(n, 2), one = keep_two_thirds(n, 1);
    EXPECT_EQ(transferred_by(one.stages[0]).tile_bytes, transferred_by(two.stages[0]).tile_bytes);
    EXPECT_EQ(one.stages[0].memory.single * 2, two.stages[0].memory.single);
  }
}

TEST(Tiles, TellWhatAProgramWithRoomWouldNotHaveMoved) {
  Machine machine({.cores = 1, .capacity = Bytes(64 * 1024), .record = true});
  std::vector<P::U32> words(100);
  const Words all(words.data(), 100);
  const auto passed = [&](const TilePlan& plan, const PassingBlock<P, P::U32>& block) {
    {
      const auto stage = machine.stage("s");
      for_each_tile<P>(
          machine, plan, [](int, const Tile&, Words) {}, block);
    }
    return transferred_by(machine.take_job().stages[0]);
  };
  const Transferred once = passed(TilePlan(10, 90, 20, 3, 100), {"once", all});
  EXPECT_EQ(once.tile_bytes, Bytes(4 * (80 + 4 * 6)));
  EXPECT_EQ(once.tile_bytes_more, Bytes(4 * 4 * 6));  // the reach of four tiles
  EXPECT_EQ(passed(TilePlan(0, 100, 20, 0, 100), {"again", all, 1, true}).tile_bytes_more,
            Bytes(400));
}

TEST(Tiles, OfAMemoryBeforeExternalMemoryComeFromThere) {
  Machine machine({.cores = 1, .memory = "L2", .record = true, .external = Bytes(4096)});
  const Words behind = machine.behind().alloc<Words>("block", 100);
  {
    const auto stage = machine.stage("s");
    for_each_tile<P>(
        machine, TilePlan(0, 100, 20, 0, 100), [](int, const Tile&, Words) {},
        PassingBlock<P, P::U32>{"block", behind});
  }
  const Job job = machine.take_job();
  const Transferred moved = transferred_by(job.stages[0]);
  EXPECT_EQ(moved.external, Bytes(400));
  EXPECT_EQ(moved.bytes, Bytes(0));
  EXPECT_EQ(moved.tiles, 5);
  EXPECT_EQ(machine.behind().peak(), Bytes(400));
}

/// Cycles of the stage on a chip whose DMA moves so many bytes in a cycle.
std::int64_t cycles_of(const Job& job, double bytes_per_cycle) {
  sim::ChipConfig config = sim::test_chip();
  config.cluster.dma.bytes_per_cycle = bytes_per_cycle;
  sim::Chip chip(config, 1);
  sim::JobTiming timing;
  const auto body = [&]() -> sim::Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn("test", body());
  EXPECT_EQ(chip.kernel().run(), 0U);
  return timing.stages[0].cycles.count();
}

// What cannot hide is the first tile on its way in and the last on its way out.
TEST(Tiles, HideWhereTheDmaIsTwiceAsFastAsTheWalk) {
  constexpr int kWords = 20'000, kTiles = 100;
  const Passed passed = add_one_to_all(kWords, kWords / kTiles, 20);
  const auto walk = static_cast<double>(cycles_of(passed.job, 1e9));
  const double twice = 2.0 * 4 * kWords / walk;  // in each direction
  const auto tiled = static_cast<double>(cycles_of(passed.job, twice));
  EXPECT_GT(tiled, walk);
  EXPECT_LT((tiled - walk) / tiled, 0.02);
  // A DMA that is half as fast as the walk cannot.
  EXPECT_GT(static_cast<double>(cycles_of(passed.job, twice / 4)), 1.8 * walk);
}

}  // namespace
}  // namespace leviosim::work
