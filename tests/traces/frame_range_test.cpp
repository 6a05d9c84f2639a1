#include "traces/datasets/frame_range.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"

namespace leviosim::traces {
namespace {

TEST(FrameRange, ReadsBeginAndEnd) {
  const FrameRange range = parse_frame_range("7:300");
  EXPECT_EQ(range.begin, 7u);
  EXPECT_EQ(range.end, 300u);
}

TEST(FrameRange, RefusesEverythingElse) {
  for (const char* text : {"", ":", "5", "5:", ":5", "5:5", "6:5", "-1:5", "0:5:1", "a:b", "0: 5",
                           "0:1e2", "0:99999999999999999999999"})
    testing::expect_input_error([&] { parse_frame_range(text); },
                                {fmt::format("'{}'", text), "A:B with 0 <= A < B", "0:100"});
}

}  // namespace
}  // namespace leviosim::traces
