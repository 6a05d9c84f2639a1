// How runs are set up that are compared with the paper.
#include "tools/app/validation/as_released.h"

#include <gtest/gtest.h>

namespace leviosim::tools {
namespace {

using Overrides = std::vector<std::string>;

Overrides overrides_of(const std::string& profile, const Overrides& given) {
  RunOptions options;
  options.profile = profile;
  options.overrides = given;
  return as_released(options).overrides;
}

TEST(ReleasedWork, IsLeviosOnly) {
  EXPECT_EQ(overrides_of("levio", {"cluster.workers=4"}),
            (Overrides{"cluster.workers=4", "workload.released=on"}));
  EXPECT_EQ(overrides_of("next", {}), Overrides{});
}

TEST(ReleasedWork, IsWhatTheOptionsSayIfTheySayIt) {
  const Overrides off{"workload.released=off"};
  EXPECT_EQ(overrides_of("levio", off), off);
}

}  // namespace
}  // namespace leviosim::tools
