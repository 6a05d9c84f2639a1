// Kernels other than LEVIO's against published cycles of a sibling chip
// (FACTS.md#published-kernels), through the interface that any workload uses. Nothing of the model
// was fitted to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/work/op.h"
#include "tests/validation/int8_product.h"
#include "tests/validation/int8_product_code.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/kernel_job.h"
#include "tools/app/validation/microbench/library_kernels.h"
#include "tools/app/validation/microbench/library_programs.h"
#include "tools/app/validation/microbench/microbench_report.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "workload/levio/geometry/essential_ransac.h"

namespace leviosim::tools {
namespace {

using work::Core;
using work::Machine;
using P = work::Counting;
using I32 = P::I32;

const std::vector<std::string> kByHand(kLibraryChip.begin(), kLibraryChip.end());
/// With what compilers add.
const std::vector<std::string> kSibling(kLibraryChip.begin(), kLibraryChip.begin() + 2);

std::vector<MicrobenchRow> rows(const std::vector<std::string>& overrides) {
  const sim::ChipConfig chip = platform::load_platform("gap9", overrides);
  std::vector<MicrobenchRow> all;
  for (const KernelJob& kernel : library_kernels(chip)) {
    all.push_back(kernel.row);
    all.back().simulated = kernel.cycles_on(chip);
  }
  return all;
}

std::vector<MicrobenchRow> of_cores(const std::vector<MicrobenchRow>& all, int cores) {
  std::vector<MicrobenchRow> some;
  std::copy_if(all.begin(), all.end(), std::back_inserter(some),
               [&](const MicrobenchRow& row) { return row.cores == cores; });
  return some;
}

/// Eight cores over one.
std::vector<MicrobenchRow> speed_ups(const std::vector<MicrobenchRow>& all) {
  std::vector<MicrobenchRow> result;
  for (const MicrobenchRow& many : of_cores(all, 8))
    for (const MicrobenchRow& one : of_cores(all, 1))
      if (one.group == many.group && one.name == many.name) {
        result.push_back(many);
        result.back().unit = "x";
        result.back().reference = result.back().reference_high = one.reference / many.reference;
        result.back().simulated = one.simulated / many.simulated;
      }
  return result;
}

void print(const char* title, const std::vector<MicrobenchRow>& all) {
  std::printf("%s\n", title);
  for (const auto& list : {all, speed_ups(all)})
    for (const MicrobenchRow& row : list)
      std::printf("  %-22s %-12s %d %-6s %10.2f %10.2f %+6.1f %%\n", row.group.c_str(),
                  row.name.c_str(), row.cores, row.unit.c_str(), row.reference, row.simulated,
                  100 * row.error());
  std::printf("  mean: one core %.1f %%, eight %.1f %%, speed-ups %.1f %%\n",
              100 * mean_error(of_cores(all, 1)), 100 * mean_error(of_cores(all, 8)),
              100 * mean_error(speed_ups(all)));
}

/// Code that was scheduled by hand says itself what compilers add to other code. What is missed are
/// addresses that were computed anew around a 4x2 block (published cycles leave room for twice the
/// instructions that it needs), and a fifth of the convolution's inner step.
TEST(ValidationDspKernels, MeanErrorsAreWithinWhatIsWanted) {
  const std::vector<MicrobenchRow> all = rows(kByHand);
  print("by hand", all);
  EXPECT_LE(mean_error(of_cores(all, 1)), 0.10);
  EXPECT_LE(mean_error(of_cores(all, 8)), 0.12);
  EXPECT_LE(mean_error(speed_ups(all)), 0.05);
}

/// What the platform says that compilers add is of C code whose values do not all fit into
/// registers: on top of these kernels it is counted twice.
TEST(ValidationDspKernels, WhatCompilersAddIsNotInThem) {
  const std::vector<MicrobenchRow> all = rows(kSibling);
  print("as compiled", all);
  EXPECT_GT(mean_error(of_cores(all, 1)), 0.10);
  EXPECT_LE(mean_error(speed_ups(all)), 0.05);
}

/// A loop whose iterations depend on nothing but their number may be held by hardware: three deep,
/// only the columns of blocks jump.
TEST(ValidationDspKernels, HardwareRepeatsAllButTheColumns) {
  Machine machine({.cores = 1, .capacity = Bytes(65536), .record = true});
  {
    const auto stage = machine.stage("product");
    using Words = P::Span<P::I32>;
    const auto a = block<Words>(machine, "a", 256), b = block<Words>(machine, "b", 256);
    const auto c = block<Words>(machine, "c", 256);
    machine.fork("product", [&](Core& core) { multiply_int32<P>(a, b, c, 16, core); });
  }
  const work::Counts counts = work::counts_of(machine.take_job().stages[0]);
  EXPECT_EQ(counts[work::Op::LoopJump], 16u / 2);
  EXPECT_EQ(counts[work::Op::IntMac], 16u * 16 * 16);
  EXPECT_EQ(counts[work::Op::LoadStream], 16u * 16 * 16);
}

/// c = a b of n x n floats in blocks of 2x4: an inner step loads six and has eight products in a
/// row.
void multiply_float(In<P, P::F32> a, In<P, P::F32> b, Out<P, P::F32> c, int n, const Core& core) {
  using F = P::F32;
  for (int column = 4 * core.id; column < n; column += 4 * core.cores)
    for (const int row : P::range(0, n / 2)) {
      F sums[2][4] = {};
      for (const int k : P::range(0, n)) {
        const F left[2] = {a[2 * row * n + k], a[(2 * row + 1) * n + k]};
        for (int j = 0; j < 4; ++j) {
          const F right = b[k * n + column + j];
          for (int i = 0; i < 2; ++i) sums[i][j] += left[i] * right;
        }
      }
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 4; ++j) c[(2 * row + i) * n + column + j] = sums[i][j];
    }
}

/// Runs of products on units that pairs of cores share (FACTS.md#collisions).
TEST(ValidationDspKernels, FloatProductsSpeedUpAsInAnOpenSimulator) {
  constexpr int kSize = 32;
  const sim::ChipConfig chip = platform::load_platform("gap9");
  const auto cycles = [&](int cores) {
    Bench bench(chip, cores);
    const sim::StageTiming timing = bench.run([&](Machine& m) {
      const work::Arena::Frame frame(m.local());
      using Floats = P::Span<P::F32>;
      const auto a = block<Floats>(m, "a", kSize * kSize), b = block<Floats>(m, "b", kSize * kSize);
      const auto c = block<Floats>(m, "c", kSize * kSize);
      m.fork("product", [&](Core& core) { multiply_float(a, b, c, kSize, core); });
    });
    return static_cast<double>(timing.cycles.count());
  };
  const double gain = cycles(1) / cycles(8);
  std::printf("  float products: x%.2f for x5.85\n", gain);
  EXPECT_NEAR(gain / 5.85, 1, 0.15);
}

/// Bytes by hand: what is spilled, and addresses that are computed anew, are no operations of the
/// source, so the code is measured as compiled, with an instruction for a packed operation. All of
/// it is cold once, which eight cores wait for together. Of n = 16 there are four columns of
/// blocks, so four of eight cores have nothing to do.
TEST(ValidationDspKernels, ProductsOfBytesTakeWhatTheyDoInAnOpenSimulator) {
  std::vector<std::string> overrides = kByHand;
  overrides.emplace_back("isa.code=rv32imfc");  // where the table stands that is read here
  const sim::ChipConfig chip = platform::load_platform("gap9", overrides);
  const platform::CodeTable table = int8_product_code().back();
  ASSERT_EQ(table.set, "rv32imfc_xpulp");
  const work::CodeMap code = platform::code_map_from("int8_product_code.h", table.text);
  for (const auto& [n, cores, reference] : {std::tuple(16, 1, 5932.0), std::tuple(32, 1, 38708.0),
                                            std::tuple(16, 8, 1802.0), std::tuple(32, 8, 5828.0)}) {
    Bench bench(chip, cores, &code);
    const int size = n;
    const double cycles = static_cast<double>(
        bench
            .run([&](Machine& m) {
              const work::Arena::Frame frame(m.local());
              const auto a = block<P::Span<work::I8x4<P>>>(m, "a", size * size / 4);
              const auto b = block<P::Span<work::I8x4<P>>>(m, "b", size * size / 4);
              const auto c = block<P::Span<I32>>(m, "c", size * size);
              m.fork("product",
                     [&](Core& core) { multiply_int8<P>(a, b, c, size, core.id, core.cores); });
            })
            .cycles.count());
    std::printf("  bytes, n = %d on %d: %.0f cycles for %.0f\n", n, cores, cycles, reference);
    EXPECT_NEAR(cycles / reference, 1, 0.15) << n << " on " << cores;
  }
}

/// A division per match, of which eight cores ask for more than one divider has, and fewer cores
/// queue (FACTS.md#collisions). On one core the operands lie on word boundaries. From one to
/// two the reference gains 27 cycles and the model 15, of which straddling words are most.
TEST(ValidationDspKernels, SampsonErrorsTakeWhatTheyDoInAnOpenSimulator) {
  constexpr int kMatches = 60;
  constexpr int kHypotheses = 20;
  const sim::ChipConfig chip = platform::load_platform("gap9");
  const std::vector<P::F32> values(2 * kMatches, P::F32(0.1F));
  for (const auto& [cores, reference] :
       {std::pair(1, 69.0), std::pair(2, 96.0), std::pair(4, 100.0), std::pair(8, 126.0)}) {
    Bench bench(chip, cores, &platform::compiled_code());
    const bool straddles = cores > 1;
    const auto fork = [&](int hypotheses) {
      return static_cast<double>(
          bench
              .fork([&](Core&) {
                P::F32 essential[9] = {0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F, 0.7F, 0.8F, 0.9F};
                P::F32 error_sum = 0.0F;
                I32 inliers = 0;
                std::vector<P::Byte> mask(kMatches);
                const P::Span<const P::F32> operands(values.data(), 2 * kMatches, straddles);
                for (int h = 0; h < hypotheses; ++h)
                  vio::levio::score_essential<P>({P::Span<P::F32>(essential, 9, straddles), 3, 3},
                                                 {operands, operands, kMatches}, 1e-6F,
                                                 {mask.data(), kMatches},
                                                 {{&inliers, 1}, {&error_sum, 1}});
              })
              .cycles.count());
    };
    const double match = (fork(2 * kHypotheses) - fork(kHypotheses)) / (kHypotheses * kMatches);
    std::printf("  Sampson, %d cores: %.1f cycles a match for %.0f\n", cores, match, reference);
    // A miss that is known: without a factor on instructions two and four cores are 20 and 17 % too
    // fast.
    EXPECT_NEAR(match / reference, 1, 0.2) << match << " cycles on " << cores;
  }
}

TEST(ValidationDspKernels, NoOrderingIsWrong) {
  const std::vector<MicrobenchRow> all = rows(kByHand);
  for (const MicrobenchRow& a : all)
    for (const MicrobenchRow& b : all)
      if (a.reference < 0.8 * b.reference) {
        EXPECT_LT(a.simulated, b.simulated) << a.group << a.name << b.group << b.name;
      }
}

TEST(ValidationDspKernels, TheKernelsComputeWhatTheySay) {
  using N = work::Native;
  constexpr int kSize = 16;
  std::vector<std::int32_t> a(kSize * kSize), b(a.size()), c(a.size());
  std::vector<work::I16x2<N>> pairs_a(a.size() / 2), pairs_b(a.size() / 2);
  for (int i = 0; i < kSize * kSize; ++i) {
    const auto k = static_cast<std::size_t>(i);
    a[k] = i * 7 % 31 - 15;
    b[k] = i * 11 % 29 - 14;
    pairs_a[k / 2].lanes[i % 2] = static_cast<std::int16_t>(a[k]);
    pairs_b[k / 2].lanes[i % 2] = static_cast<std::int16_t>(b[k]);
  }
  const auto expect_product = [&] {
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        int sum = 0;
        for (int k = 0; k < kSize; ++k)
          sum += a[static_cast<std::size_t>(y * kSize + k)] *
                 b[static_cast<std::size_t>(k * kSize + x)];
        EXPECT_EQ(c[static_cast<std::size_t>(y * kSize + x)], sum) << y << " " << x;
      }
  };
  work::Machine machine({.cores = 3, .capacity = Bytes(1024)});
  const auto stage = machine.stage("products");
  constexpr int kAll = kSize * kSize;
  machine.fork("int32", [&](Core& core) {
    multiply_int32<N>({a.data(), kAll}, {b.data(), kAll}, {c.data(), kAll}, kSize, core);
  });
  expect_product();
  std::fill(c.begin(), c.end(), 0);
  machine.fork("int16", [&](Core& core) {
    multiply_int16<N>({pairs_a.data(), kAll / 2}, {pairs_b.data(), kAll / 2}, {c.data(), kAll},
                      kSize, core);
  });
  expect_product();
  std::fill(c.begin(), c.end(), 0);
  std::vector<work::I8x4<N>> bytes_a(a.size() / 4), bytes_b(a.size() / 4);
  for (std::size_t k = 0; k < a.size(); ++k) {
    bytes_a[k / 4].lanes[k % 4] = static_cast<std::int8_t>(a[k]);
    bytes_b[k / 4].lanes[k % 4] = static_cast<std::int8_t>(b[k]);
  }
  for (int core = 0; core < 3; ++core)
    multiply_int8<N>({bytes_a.data(), kAll / 4}, {bytes_b.data(), kAll / 4}, {c.data(), kAll},
                     kSize, core, 3);
  expect_product();
  for (const auto& [n, m] : {std::pair(40, 24), std::pair(24, 40), std::pair(32, 32)}) {
    std::vector<std::int32_t> out(static_cast<std::size_t>(n + m - 1));
    convolve_int32<N>({a.data(), n}, {b.data(), m}, {out.data(), n + m - 1});
    for (int t = 0; t < n + m - 1; ++t) {
      int sum = 0;
      for (int j = std::max(0, t + 1 - n); j < std::min(m, t + 1); ++j)
        sum += a[static_cast<std::size_t>(t - j)] * b[static_cast<std::size_t>(j)];
      EXPECT_EQ(out[static_cast<std::size_t>(t)], sum) << n << " with " << m << ": " << t;
    }
  }
}

}  // namespace
}  // namespace leviosim::tools
