// Marks of offload regions: what is computed inside of them is theirs, and counted as ever.
#include "sim/work/offload_regions.h"

#include <gtest/gtest.h>

#include "sim/work/machine.h"

namespace leviosim::work {
namespace {

using P = Counting;

F32 add_up(int n) {
  F32 sum = 0.0f;
  for (int i : P::range(0, n)) sum += F32(static_cast<float>(i));
  return sum;
}

Segment recorded(const std::function<void()>& compute, bool offload = true) {
  Machine machine({.cores = 1, .record = true, .offload = offload});
  {
    const auto stage = machine.stage("s");
    compute();
  }
  return segments_of(machine.take_job().stages.at(0));
}

TEST(OffloadRegions, HoldWhatIsComputedInsideOfThem) {
  const Segment segment = recorded([] {
    add_up(5);
    {
      const P::OffloadRegion kernel(OffloadKind::Hamming, 7);
      add_up(10);
    }
    add_up(100);
    {
      const P::OffloadRegion kernel(OffloadKind::Hamming, 3);
      add_up(20);
    }
  });
  EXPECT_EQ(segment[Op::F32Add], 135u);
  ASSERT_EQ(segment.offload.size(), 1u);
  EXPECT_EQ(segment.offload[0].kernel, OffloadKind::Hamming);
  EXPECT_EQ(segment.offload[0].calls, 2u);
  EXPECT_EQ(segment.offload[0].items, 10u);
  EXPECT_EQ(segment.offload[0].counts[Op::F32Add], 30u);
  EXPECT_EQ(segment.offload[0].counts[Op::LoopEntry], 2u);
}

TEST(OffloadRegions, AreNotFollowedWhereTheMachineDoesNotAskForThem) {
  const auto compute = [] {
    const P::OffloadRegion kernel(OffloadKind::Hamming, 7);
    add_up(10);
  };
  const Segment with = recorded(compute), without = recorded(compute, false);
  EXPECT_EQ(with.offload.size(), 1u);
  EXPECT_TRUE(without.offload.empty());
  EXPECT_EQ(static_cast<const Counts&>(without), static_cast<const Counts&>(with));
  EXPECT_TRUE(offload_followed) << "outside of stages of a machine marks count";
}

/// Loads that straddle, branches that are not taken: the tally has them in another form.
TEST(OffloadRegions, CountAsTheTallyDoes) {
  const auto compute = [] {
    const P::OffloadRegion kernel(OffloadKind::Eigen3, 1);
    std::array<F32, 8> values{};
    const P::Span<F32> span(values.data(), 8, true);
    F32 sum = 0.0f;
    for (int i : P::range(0, 8)) {
      if (F32(span[i]) < sum) sum += 1.0f;
      if (unlikely(F32(span[i]) < 1.0f)) sum += 1.0f;
    }
  };
  const Segment segment = recorded(compute);
  ASSERT_EQ(segment.offload.size(), 1u);
  Counts all = segment;
  all.code = {};
  EXPECT_EQ(segment.offload[0].counts, all);
  EXPECT_GT(all[Op::Straddle], 0u);
}

TEST(OffloadRegions, DoNotNest) {
  const Segment segment = recorded([] {
    const P::OffloadRegion outer(OffloadKind::Eigen9, 1);
    add_up(5);
    const P::OffloadRegion inner(OffloadKind::Solve, 1);
    add_up(6);
  });
  ASSERT_EQ(segment.offload.size(), 1u);
  EXPECT_EQ(segment.offload[0].kernel, OffloadKind::Eigen9);
  EXPECT_EQ(segment.offload[0].counts[Op::F32Add], 11u);
}

TEST(OffloadRegions, WithoutAKindThereIsNoMark) {
  const Segment segment = recorded([] {
    const P::OffloadRegion none({}, 1);
    const P::OffloadRegion kernel(OffloadKind::Solve, 1);
    add_up(6);
  });
  ASSERT_EQ(segment.offload.size(), 1u);
  EXPECT_EQ(segment.offload[0].kernel, OffloadKind::Solve);
}

TEST(OffloadRegions, BelongToTheCoreThatMakesThem) {
  Machine machine({.cores = 3, .record = true});
  {
    const auto stage = machine.stage("s");
    machine.fork("f", [](Core& core) {
      const P::OffloadRegion kernel(OffloadKind::Corners, core.id);
      add_up(core.id + 1);
    });
    add_up(4);
  }
  const Job job = machine.take_job();
  const auto& fork = std::get<Fork>(job.stages.at(0).steps.at(0));
  for (std::size_t id = 0; id < 3; ++id) {
    ASSERT_EQ(fork.shares[id].offload.size(), 1u);
    EXPECT_EQ(fork.shares[id].offload[0].items, id);
    EXPECT_EQ(fork.shares[id].offload[0].counts[Op::F32Add], id + 1);
  }
  EXPECT_TRUE(std::get<Serial>(job.stages[0].steps.at(1)).counts.offload.empty());
}

TEST(OffloadRegions, OfSegmentsAddUpByKind) {
  const auto of = [](OffloadKind kind, std::uint64_t n) {
    Counts counts;
    counts[Op::IntAlu] = n;
    return Segment(counts, {{kind, n, 10 * n, counts}});
  };
  Segment sum = of(OffloadKind::Hamming, 1);
  sum += of(OffloadKind::Eigen3, 2);
  sum += of(OffloadKind::Solve, 3);
  sum += of(OffloadKind::Hamming, 4);
  EXPECT_EQ(sum[Op::IntAlu], 10u);
  ASSERT_EQ(sum.offload.size(), 3u);
  EXPECT_EQ(sum.offload[0].kernel, OffloadKind::Eigen3);
  EXPECT_EQ(sum.offload[1].calls, 5u);
  EXPECT_EQ(sum.offload[1].items, 50u);
  EXPECT_EQ(sum.offload[2].kernel, OffloadKind::Solve);
}

}  // namespace
}  // namespace leviosim::work
