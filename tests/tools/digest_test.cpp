#include "tools/app/run/run_folder.h"

#include <gtest/gtest.h>

#include "sim/base/csv.h"
#include "sim/outputs/file_system.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"

namespace leviosim::tools {
namespace {

TEST(InputDigests, ChangeWithAPixelOfAFrameInRangeOnly) {
  const traces::testing::AslFolder asl;
  const auto digests = [&] {
    return digest_inputs(traces::open_asl(asl.root(), {.frames = traces::FrameRange{0, 3}}));
  };
  const std::vector<InputDigest> before = digests();
  ASSERT_EQ(before.size(), 6u);
  const auto append = [&](int frame) {
    outputs::write_file_atomically(asl.image(frame), base::read_text_file(asl.image(frame)) + "x");
  };
  append(4);
  EXPECT_EQ(digests().back().sha256, before.back().sha256);
  append(2);
  EXPECT_NE(digests().back().sha256, before.back().sha256);
  EXPECT_EQ(digests().front().sha256, before.front().sha256);
}

}  // namespace
}  // namespace leviosim::tools
