// Kernels measured on a GAP8 board (FACTS.md#gap8-kernels) against the gap8 platform, of which
// nothing was fitted to them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "sim/base/error.h"
#include "tools/app/validation/microbench/board_kernels.h"
#include "tools/app/validation/microbench/microbench_report.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "tools/app/validation/microbench/reference_rows.h"

namespace leviosim::tools {
namespace {

std::vector<MicrobenchRow> rows_of_board() {
  const platform::Variants gap8(platform::resolve_platform("gap8"));
  return board_rows(board_kernels(gap8.config({})), gap8);
}

TEST(ValidationGap8Board, MeanErrorOfTheCyclesIsWithinTwelvePercent) {
  std::vector<MicrobenchRow> rows = rows_of_board();
  std::erase_if(rows, [](const MicrobenchRow& row) { return row.unit != "cycles"; });
  ASSERT_EQ(rows.size(), 18U);
  EXPECT_LE(mean_error(rows), 0.12);
}

/// Rows that are off by more than their tolerance have a guard, and no guard is without need.
TEST(ValidationGap8Board, NoRowIsWorseThanItsToleranceOrItsGuard) {
  const std::vector<MicrobenchRow> rows = rows_of_board();
  ASSERT_EQ(rows.size(), 27U);
  for (const MicrobenchRow& row : rows)
    EXPECT_TRUE(row.verdict() == Verdict::Met || row.verdict() == Verdict::Missed)
        << row.group << ", " << row.name << ", " << row.cores << " is " << name_of(row.verdict())
        << ": error " << row.error() << ", tolerance " << row.tolerance << ", guard "
        << row.guard.value_or(row.tolerance);
}

TEST(ValidationGap8Board, AGuardBelongsToARowThatExistsAndIsWiderThanItsTolerance) {
  const std::string header = "group,name,cores,unit,guard,reason\n";
  std::vector<MicrobenchRow> rows(1);
  rows[0].group = "pool";
  rows[0].name = "scalar, speed-up";
  rows[0].unit = "x";
  take_guards("g.csv", header + "pool,scalar,1,x,0.2,why\n", rows);
  EXPECT_EQ(rows[0].guard, 0.2);
  for (const char* line : {"pool,SIMD,1,x,0.2,why\n", "pool,scalar,2,x,0.2,why\n",
                           "pool,scalar,1,cycles,0.2,why\n", "pool,scalar,1,x,0.05,why\n"})
    EXPECT_THROW(take_guards("g.csv", header + line, rows), InputError) << line;
}

}  // namespace
}  // namespace leviosim::tools
