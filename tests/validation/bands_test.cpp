// Bands of times against what was published: how many references lie inside, and whether the range
// of code that was not measured is what kernels with published cycles need.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "tools/app/validation/microbench/board_kernels.h"
#include "tools/app/validation/microbench/kernel_job.h"
#include "tools/app/validation/microbench/library_kernels.h"
#include "tools/app/validation/microbench/microbench_row.h"

namespace leviosim::tools {
namespace {

struct Kernels {
  platform::Variants chip;
  std::vector<KernelJob> jobs;
};

Kernels of_board() {
  const platform::Variants chip(platform::resolve_platform("gap8"));
  return {chip, board_kernels(chip.config({}))};
}

Kernels of_library() {
  const platform::Variants chip(
      platform::resolve_platform("gap9", {kLibraryChip.begin(), kLibraryChip.end()}));
  return {chip, library_kernels(chip.config({}))};
}

/// At least four fifths, without bands that say nothing: most are no wider than the figure.
TEST(ValidationBands, HoldFourFifthsOfPublishedKernels) {
  for (const Kernels& kernels : {of_board(), of_library()}) {
    std::vector<Banded> bands;
    std::size_t inside = 0;
    for (const MicrobenchRow& row : banded_rows(kernels.jobs, kernels.chip)) {
      inside += row.is_inside() ? 1 : 0;
      bands.push_back(*row.band);
      EXPECT_LE(row.band->low, row.simulated);
      EXPECT_GE(row.band->high, row.simulated);
    }
    EXPECT_GE(static_cast<double>(inside), 0.8 * static_cast<double>(bands.size()));
    EXPECT_LT(median_half_width(bands), 50);
  }
}

/// Its low end is what the least of them needs.
TEST(ValidationBands, OfUnmeasuredCodeBeginWhereKernelsDo) {
  std::vector<double> needed;
  for (const Kernels& kernels : {of_board(), of_library()})
    for (const double factor : needed_instructions(kernels.jobs, kernels.chip))
      needed.push_back(factor);
  EXPECT_EQ(needed.size(), 17u) << "loads from L2 say nothing of code";
  std::sort(needed.begin(), needed.end());
  const auto range = of_library().chip.find("isa.unmeasured_instructions")->range;
  EXPECT_NEAR(needed.front(), range->low, 0.02);
  EXPECT_LE(needed.back(), range->high);
}

}  // namespace
}  // namespace leviosim::tools
