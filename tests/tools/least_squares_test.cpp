// The fit of constants between bounds, where the best lies at a bound.
#include "tools/app/validation/calibration/calibration.h"

#include <gtest/gtest.h>

#include <vector>

namespace leviosim::tools {
namespace {

/// Lowest at (-0.25, 0.75); for x = 0 at y = 51 / 101.
std::vector<double> valley(const std::vector<double>& at) {
  return {10 * (at[0] + at[1]) - 5, at[0] - at[1] + 1};
}

TEST(LeastSquares, AnUnknownThatIsPushedOutwardsIsHeldAtItsBound) {
  for (const double x : {0.0, 0.5, 1.0}) {
    SCOPED_TRACE(x);
    const Fit low = least_squares(valley, {{0, 0}, {1, 1}}, {x, 0.9});
    EXPECT_DOUBLE_EQ(low.at[0], 0);
    EXPECT_NEAR(low.at[1], 51.0 / 101, 1e-7);
    const auto mirrored = [](const std::vector<double>& at) {
      return valley({1 - at[0], 1 - at[1]});
    };
    const Fit high = least_squares(mirrored, {{0, 0}, {1, 1}}, {x, 0.1});
    EXPECT_DOUBLE_EQ(high.at[0], 1);
    EXPECT_NEAR(high.at[1], 50.0 / 101, 1e-7);
  }
}

TEST(LeastSquares, AnUnknownThatIsPulledInwardsLeavesItsBound) {
  const Fit fit = least_squares(valley, {{-1, -1}, {1, 1}}, {-1, -1});
  EXPECT_NEAR(fit.at[0], -0.25, 1e-7);
  EXPECT_NEAR(fit.at[1], 0.75, 1e-7);
}

}  // namespace
}  // namespace leviosim::tools
