// Marks of calls of kernels: what is computed inside of them is theirs, and counted as ever.
#include "sim/work/kernel_calls.h"

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

Piece recorded(const std::function<void()>& compute, bool kernels = true) {
  Machine machine({.cores = 1, .record = true, .kernels = kernels});
  {
    const auto stage = machine.stage("s");
    compute();
  }
  return pieces_of(machine.take_job().stages.at(0));
}

TEST(KernelCalls, HoldWhatIsComputedInsideOfThem) {
  const Piece piece = recorded([] {
    add_up(5);
    {
      const P::Kernel kernel(KernelKind::Hamming, 7);
      add_up(10);
    }
    add_up(100);
    {
      const P::Kernel kernel(KernelKind::Hamming, 3);
      add_up(20);
    }
  });
  EXPECT_EQ(piece[Op::F32Add], 135u);
  ASSERT_EQ(piece.kernels.size(), 1u);
  EXPECT_EQ(piece.kernels[0].kernel, KernelKind::Hamming);
  EXPECT_EQ(piece.kernels[0].calls, 2u);
  EXPECT_EQ(piece.kernels[0].items, 10u);
  EXPECT_EQ(piece.kernels[0].counts[Op::F32Add], 30u);
  EXPECT_EQ(piece.kernels[0].counts[Op::LoopEntry], 2u);
}

TEST(KernelCalls, AreNotFollowedWhereTheMachineDoesNotAskForThem) {
  const auto compute = [] {
    const P::Kernel kernel(KernelKind::Hamming, 7);
    add_up(10);
  };
  const Piece with = recorded(compute), without = recorded(compute, false);
  EXPECT_EQ(with.kernels.size(), 1u);
  EXPECT_TRUE(without.kernels.empty());
  EXPECT_EQ(static_cast<const Counts&>(without), static_cast<const Counts&>(with));
  EXPECT_TRUE(kernels_followed) << "outside of stages of a machine marks count";
}

/// Loads that straddle, branches that are not taken: the tally has them in another form.
TEST(KernelCalls, CountAsTheTallyDoes) {
  const auto compute = [] {
    const P::Kernel kernel(KernelKind::Eigen3, 1);
    std::array<F32, 8> values{};
    const P::Span<F32> span(values.data(), 8, true);
    F32 sum = 0.0f;
    for (int i : P::range(0, 8)) {
      if (F32(span[i]) < sum) sum += 1.0f;
      if (unlikely(F32(span[i]) < 1.0f)) sum += 1.0f;
    }
  };
  const Piece piece = recorded(compute);
  ASSERT_EQ(piece.kernels.size(), 1u);
  Counts all = piece;
  all.code = {};
  EXPECT_EQ(piece.kernels[0].counts, all);
  EXPECT_GT(all[Op::Straddle], 0u);
}

TEST(KernelCalls, DoNotNest) {
  const Piece piece = recorded([] {
    const P::Kernel outer(KernelKind::Eigen9, 1);
    add_up(5);
    const P::Kernel inner(KernelKind::Solve, 1);
    add_up(6);
  });
  ASSERT_EQ(piece.kernels.size(), 1u);
  EXPECT_EQ(piece.kernels[0].kernel, KernelKind::Eigen9);
  EXPECT_EQ(piece.kernels[0].counts[Op::F32Add], 11u);
}

TEST(KernelCalls, WithoutAKindThereIsNoMark) {
  const Piece piece = recorded([] {
    const P::Kernel none({}, 1);
    const P::Kernel kernel(KernelKind::Solve, 1);
    add_up(6);
  });
  ASSERT_EQ(piece.kernels.size(), 1u);
  EXPECT_EQ(piece.kernels[0].kernel, KernelKind::Solve);
}

TEST(KernelCalls, BelongToTheCoreThatMakesThem) {
  Machine machine({.cores = 3, .record = true});
  {
    const auto stage = machine.stage("s");
    machine.fork("f", [](Core& core) {
      const P::Kernel kernel(KernelKind::Corners, core.id);
      add_up(core.id + 1);
    });
    add_up(4);
  }
  const Job job = machine.take_job();
  const auto& fork = std::get<Fork>(job.stages.at(0).steps.at(0));
  for (std::size_t id = 0; id < 3; ++id) {
    ASSERT_EQ(fork.shares[id].kernels.size(), 1u);
    EXPECT_EQ(fork.shares[id].kernels[0].items, id);
    EXPECT_EQ(fork.shares[id].kernels[0].counts[Op::F32Add], id + 1);
  }
  EXPECT_TRUE(std::get<Serial>(job.stages[0].steps.at(1)).counts.kernels.empty());
}

TEST(KernelCalls, OfPiecesAddUpByKind) {
  const auto of = [](KernelKind kind, std::uint64_t n) {
    Counts counts;
    counts[Op::IntAlu] = n;
    return Piece(counts, {{kind, n, 10 * n, counts}});
  };
  Piece sum = of(KernelKind::Hamming, 1);
  sum += of(KernelKind::Eigen3, 2);
  sum += of(KernelKind::Solve, 3);
  sum += of(KernelKind::Hamming, 4);
  EXPECT_EQ(sum[Op::IntAlu], 10u);
  ASSERT_EQ(sum.kernels.size(), 3u);
  EXPECT_EQ(sum.kernels[0].kernel, KernelKind::Eigen3);
  EXPECT_EQ(sum.kernels[1].calls, 5u);
  EXPECT_EQ(sum.kernels[1].items, 50u);
  EXPECT_EQ(sum.kernels[2].kernel, KernelKind::Solve);
}

}  // namespace
}  // namespace leviosim::work
