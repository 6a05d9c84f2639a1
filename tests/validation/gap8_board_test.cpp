// Kernels measured on a GAP8 board (FACTS.md#gap8-kernels) against the gap8 platform, of which
// nothing was fitted to them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "tools/app/validation/microbench/board_kernels.h"
#include "tools/app/validation/microbench/report.h"

namespace leviosim::tools {
namespace {

/// Rows in cycles ("cycles"), or the speed-ups ("x").
std::vector<MicrobenchRow> rows_in(const std::string& unit) {
  std::vector<MicrobenchRow> rows;
  for (const MicrobenchRow& row : board_rows(platform::load_platform("gap8")))
    if (row.unit == unit) rows.push_back(row);
  return rows;
}

TEST(ValidationGap8Board, MeanErrorOfTheCyclesIsWithinTwelvePercent) {
  const std::vector<MicrobenchRow> rows = rows_in("cycles");
  ASSERT_EQ(rows.size(), 18U);
  EXPECT_LE(mean_error(rows), 0.12);
  for (const MicrobenchRow& row : rows)
    EXPECT_LT(std::abs(row.error()), 0.25) << row.group << ", " << row.name << ", " << row.cores;
}

/// Speed-ups that miss 0.5, and how far they are off at most. On the board a call of these kernels
/// takes 400 to 700 cycles more on eight cores than an eighth of its time on one; the platform's
/// fork and barrier account for 80, conflicts of streams on the banks of L1, which are not
/// modelled, for 20 to 150 (sim/VALIDATION.md).
struct Shortfall {
  const char* group;
  const char* name;
  double most;
};
constexpr Shortfall kShortfalls[] = {
    {"2x2 max pool 112x112", "scalar, speed-up", 1.2},
    {"2x2 average pool 112x112", "scalar, speed-up", 1.2},
    {"2x2 average pool 112x112", "SIMD, speed-up", 1.1},
    {"5x5 convolution 112x112", "scalar, speed-up", 0.6},
    {"linear 1024 to 16", "scalar, speed-up", 0.7},
    {"linear 1024 to 16", "SIMD, speed-up", 1.2},
};

double allowed(const MicrobenchRow& row) {
  for (const Shortfall& shortfall : kShortfalls)
    if (row.group == shortfall.group && row.name == shortfall.name) return shortfall.most;
  return 0.5;
}

TEST(ValidationGap8Board, SpeedUpsAreWithinAHalfOrKnownToMissIt) {
  const std::vector<MicrobenchRow> rows = rows_in("x");
  ASSERT_EQ(rows.size(), 9U);
  for (const MicrobenchRow& row : rows)
    EXPECT_LE(std::abs(row.error()) * row.reference, allowed(row)) << row.group << ", " << row.name;
}

}  // namespace
}  // namespace leviosim::tools
