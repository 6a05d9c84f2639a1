// Accuracy as text: which lengths get a row.
#include "tools/app/report/accuracy_text.h"

#include <gtest/gtest.h>

namespace leviosim::tools {
namespace {

TEST(AccuracyText, ALengthWithASingleSubTrajectoryHasARow) {
  traces::RelativeErrors one, none;
  one.length_m = 40;
  one.count = 1;
  none.length_m = 80;
  const std::string text = relative_text({}, {one, none});
  EXPECT_EQ(text.find("80 m"), text.rfind("80 m"));
  EXPECT_LT(text.find("40"), text.find("80 m")) << text;
  const std::string without = relative_text({}, {none});
  EXPECT_EQ(without.find("40"), std::string::npos) << without;
  EXPECT_GT(text.size(), 2 * without.size()) << text;
}

}  // namespace
}  // namespace leviosim::tools
