// The example of workload/EXTENDING.md does what the page says, on gap9 and on the page's own chip.
#include <gtest/gtest.h>

#include <vector>

#include "platform_models/loader/loader.h"
#include "sim/base/error.h"
#include "sim/work/machine.h"
#include "sim/work/op.h"
#include "tests/examples/outside/exposure.h"
#include "tests/support/paths.h"

namespace exposure {
namespace {

constexpr int kWidth = 160, kHeight = 120;

std::vector<std::uint8_t> frame_of(int level) {
  std::vector<std::uint8_t> pixels(kWidth * kHeight);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<std::uint8_t>(level + static_cast<int>(i % 5));
  return pixels;
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
  for (const int cores : {1, 3, 8}) {
    work::Machine machine({.cores = cores});
    EXPECT_EQ(mean_level<work::Native>(machine, frame_of(10).data(), kWidth, kHeight), 12);
    EXPECT_EQ(mean_level<work::Counting>(machine, frame_of(100).data(), kWidth, kHeight), 102);
    EXPECT_EQ(mean_level<work::Counting>(machine, frame_of(100).data(), kWidth, kHeight, 7), 102);
  }
}

// [time]
Cycles exposure_on(const std::string& chip, int cores) {
  const std::vector<std::uint8_t> pixels = frame_of(100);
  const auto body = [&](work::Machine& machine) {
    mean_level<work::Counting>(machine, pixels.data(), kWidth, kHeight);
  };
  return cycles_on(platform::resolve_platform(chip), body, cores);
}

TEST(ExampleWorkload, IsFasterOnMoreCores) {
  const double one = static_cast<double>(exposure_on("gap9", 1).count());
  const double eight = static_cast<double>(exposure_on("gap9", 8).count());
  EXPECT_GT(one / eight, 4);
  EXPECT_LT(one / eight, 8);
}
// [/time]

TEST(ExampleChip, RunsTheWorkloadSlowerThanTheChipItWasMadeFrom) {
  const std::string quad = (leviosim::tests::source_folder() / "tests/examples/quad.yaml").string();
  EXPECT_GT(exposure_on(quad, 4), exposure_on("gap8", 8));
  // Without Xpulp an iteration is a load, a sum, and a loop that costs.
  EXPECT_GT(exposure_on(quad, 1).count(), 3 * kWidth * kHeight);
  EXPECT_THROW(exposure_on(quad, 5), InputError);
}

}  // namespace
}  // namespace exposure
