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

}  // namespace
}  // namespace leviosim::work
