// What a machine notes of the local memory that stages and their forks use.
#include "sim/work/machine.h"

#include <gtest/gtest.h>

namespace leviosim::work {
namespace {

using P = Counting;
using Bytewise = P::Span<P::Byte>;

/// Two cores; in a fork each takes its number of bytes.
MemoryPeak peak_of_forks(const std::vector<std::array<int, 2>>& forks, int own = 0) {
  Machine machine({.cores = 2, .capacity = Bytes(4096), .record = true});
  {
    const auto stage = machine.stage("s");
    const Arena::Frame frame(machine.local());
    if (own > 0) machine.local().alloc<Bytewise>("own", own);
    for (const std::array<int, 2>& bytes : forks)
      machine.fork("f", [&](Core& core) {
        core.scratch.alloc<Bytewise>("scratch", bytes[static_cast<std::size_t>(core.id)]);
      });
  }
  return machine.take_job().stages.at(0).memory;
}

/// Code that the second of two visits of `before` fetches, which a fork lies between.
CodeReuse fetched_behind_a_fork(int cores) {
  CodeMap map;
  map.add("before", "", 64);
  map.add("share", "", 1024);
  Machine machine({.cores = cores, .capacity = Bytes(4096), .record = true, .code = &map});
  {
    const auto stage = machine.stage("s");
    const auto visit = [] { const P::Function function("before"); };
    visit();
    machine.fork("f", [](Core&) { const P::Function function("share"); });
    visit();
  }
  return std::get<Serial>(machine.take_job().stages.at(0).steps.at(2)).counts.code;
}

// A program of one core has one cache for both.
TEST(Machine, OnOneCoreTheCodeOfAShareDisplacesWhatTheMasterExecutedBefore) {
  CodeReuse alone{}, of_team{};
  for_reuse_classes(64 + 1024, 64, [&](std::size_t k, std::uint32_t n) { alone[k] += n; });
  for_reuse_classes(64, 64, [&](std::size_t k, std::uint32_t n) { of_team[k] += n; });
  EXPECT_EQ(fetched_behind_a_fork(1), alone);
  EXPECT_EQ(fetched_behind_a_fork(2), of_team);
}

TEST(Machine, ScratchOfAllCoresCountsInParallelAndTheLargestAlone) {
  const MemoryPeak peak = peak_of_forks({{100, 60}}, 40);
  EXPECT_EQ(peak.parallel, Bytes(40 + 100 + 60));
  EXPECT_EQ(peak.single, Bytes(40 + 100));
  ASSERT_EQ(peak.blocks.size(), 2u);
  EXPECT_EQ(peak.blocks[0].size, Bytes(40));
  EXPECT_EQ(peak.blocks[1].size, Bytes(160));
}

// In the second fork no core takes more than all took in the first.
TEST(Machine, TheForkThatTakesMostInAllDecides) {
  EXPECT_EQ(peak_of_forks({{100, 0}, {80, 80}}).parallel, Bytes(160));
  EXPECT_EQ(peak_of_forks({{100, 0}, {80, 80}}).single, Bytes(100));
  EXPECT_EQ(peak_of_forks({{80, 80}, {100, 0}}).parallel, Bytes(160));
}

/// Items that each of the four cores worked on.
std::vector<int> items_by_core(Bytes scratch, int items) {
  Machine machine({.cores = 4, .capacity = Bytes(1000), .record = true});
  std::vector<int> of_core(4, 0);
  {
    const auto stage = machine.stage("s");
    machine.fork(
        "f",
        [&](Core& core) {
          core.scratch.alloc<Bytewise>("scratch", static_cast<int>(scratch.count()));
          const auto [begin, end] = core.share(items);
          of_core[static_cast<std::size_t>(core.id)] = end - begin;
        },
        scratch);
  }
  EXPECT_EQ(std::get<Fork>(machine.take_job().stages.at(0).steps.at(0)).shares.size(), 4u);
  return of_core;
}

TEST(Machine, AsManyCoresWorkAsHaveScratch) {
  EXPECT_EQ(items_by_core(Bytes(240), 12), (std::vector<int>{3, 3, 3, 3}));
  EXPECT_EQ(items_by_core(Bytes(300), 12), (std::vector<int>{4, 4, 4, 0}));
  EXPECT_EQ(items_by_core(Bytes(900), 12), (std::vector<int>{12, 0, 0, 0}));
  EXPECT_THROW(items_by_core(Bytes(1001), 12), MemoryOverflow);
}

}  // namespace
}  // namespace leviosim::work
