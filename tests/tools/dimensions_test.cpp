// Which parameters of a point act on a profile.
#include "tools/app/study/ablate/dimensions.h"
#include "workload/vio/profile.h"

#include <gtest/gtest.h>

namespace leviosim::tools {
namespace {

TEST(Dimensions, AProfileWithoutImuTakesNoParametersOfTheImu) {
  std::vector<vio::Assignment> point;
  std::size_t without_imu = 0;
  for (const vio::Parameter& parameter : vio::parameters()) {
    point.push_back({&parameter, parameter.get(vio::profile_named("levio", 1))});
    if (!parameter.needs_imu) ++without_imu;
  }
  ASSERT_GT(without_imu, 0u);
  ASSERT_LT(without_imu, point.size());
  EXPECT_EQ(effective(point, "levio").size(), point.size());
  const std::vector<vio::Assignment> left = effective(point, "levio-no-imu");
  EXPECT_EQ(left.size(), without_imu);
  for (const vio::Assignment& a : left) EXPECT_FALSE(a.parameter->needs_imu) << a.text();
}

}  // namespace
}  // namespace leviosim::tools
