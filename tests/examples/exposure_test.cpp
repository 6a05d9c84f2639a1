// The example of workload/EXTENDING.md does what the page says, on gap9 and on the page's own chip.
#include <gtest/gtest.h>

#include <numeric>

#include "platform_models/loader/loader.h"
#include "tests/examples/exposure.h"
#include "tests/support/paths.h"
#include "tools/app/report/tables.h"
#include "tools/app/run/simulate.h"

namespace leviosim::example {
namespace {

constexpr int kWidth = 160, kHeight = 120;

Frames two_frames() {
  Frames frames{kWidth, kHeight, 50'000'000, {}};
  for (const int level : {10, 100}) {
    std::vector<std::uint8_t> pixels(kWidth * kHeight);
    for (std::size_t i = 0; i < pixels.size(); ++i)
      pixels[i] = static_cast<std::uint8_t>(level + static_cast<int>(i % 5));
    frames.images.push_back(std::move(pixels));
  }
  return frames;
}

// [kernel test]
template <class P>
int sum_of(std::vector<typename P::Byte>& row) {
  const typename P::template Span<typename P::Byte> span(row.data(), static_cast<int>(row.size()));
  return work::value(row_sum<P>(span));
}

TEST(ExampleKernel, AddsUpARowAndCountsWhatItDoes) {
  std::vector<std::uint8_t> plain = {1, 2, 253};
  std::vector<work::Byte> counted = {work::Byte{1}, work::Byte{2}, work::Byte{253}};
  EXPECT_EQ(sum_of<work::Native>(plain), 256);
  work::take_tally();
  EXPECT_EQ(sum_of<work::Counting>(counted), 256);
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[work::Op::LoadStream], 3u);
  EXPECT_EQ(counts[work::Op::IntAlu], 3u);
}
// [/kernel test]

TEST(ExampleStage, GivesTheSameOnAnyNumberOfCoresAndUnderBothPolicies) {
  const Frames frames = two_frames();
  for (const int cores : {1, 3, 8}) {
    work::Machine machine({.cores = cores});
    EXPECT_EQ(mean_level<work::Native>(machine, frames.images[0].data(), kWidth, kHeight), 12);
    EXPECT_EQ(mean_level<work::Counting>(machine, frames.images[1].data(), kWidth, kHeight), 102);
  }
}

// [run]
tools::RunResult run_on(const std::string& platform, const Frames& frames, int cores) {
  tools::RunRequest request;
  request.platform = platform::resolve_platform(platform);
  request.cores = cores;
  ExposureSource source(frames, request.platform.config, cores);
  return tools::simulate_source(request, source, [](const tools::Progress&) {});
}

TEST(ExampleWorkload, IsFasterOnMoreCores) {
  const tools::RunResult run = run_on("gap9", two_frames(), 8);
  ASSERT_EQ(run.stages.size(), 1u);
  const tools::StageResult& stage = run.stages[0];
  const double speedup =
      static_cast<double>(stage.single.count()) / static_cast<double>(stage.parallel.count());
  EXPECT_GT(speedup, 4);
  EXPECT_LT(speedup, 8);
  EXPECT_NE(tools::stage_table(run).find("exposure"), std::string::npos);
}
// [/run]

TEST(ExampleChip, RunsTheWorkloadSlowerThanTheChipItWasMadeFrom) {
  const std::string quad = (leviosim::tests::source_folder() / "tests/examples/quad.yaml").string();
  const tools::RunResult on_quad = run_on(quad, two_frames(), 4);
  const tools::RunResult on_gap8 = run_on("gap8", two_frames(), 8);
  EXPECT_GT(on_quad.stages[0].parallel, on_gap8.stages[0].parallel);
  // Without Xpulp an iteration is a load, a sum, and a loop that costs.
  EXPECT_GT(on_quad.stages[0].single.count(), 3 * 2 * kWidth * kHeight);
  EXPECT_THROW(run_on(quad, two_frames(), 5), InputError);
}

}  // namespace
}  // namespace leviosim::example
