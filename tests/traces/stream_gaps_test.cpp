// Gaps of IMU and ground truth where they are easily overlooked: in the first interval, at the
// first and the last frame, and just outside of them.
#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"

namespace leviosim::traces {
namespace {

using testing::AslFolder;
using testing::expect_input_error;

constexpr const char* kImuTable = "imu0/data.csv";
constexpr const char* kTruthTable = "state_groundtruth_estimate0/data.csv";

/// Line of the sample `ms` after the first frame; samples come every 5 ms from 50 ms before it.
std::size_t line_at(int ms) { return static_cast<std::size_t>(ms / 5 + 12); }

/// Takes away the samples between those at `from_ms` and `to_ms`.
void cut(const AslFolder& folder, const char* file, int from_ms, int to_ms) {
  folder.remove_lines(file, line_at(from_ms) + 1,
                      static_cast<std::size_t>((to_ms - from_ms) / 5 - 1));
}

std::string stamp(int ms) { return std::to_string(AslFolder::kStartNs + ms * 1'000'000LL); }

TEST(ImuGaps, AreRefusedFromTheFirstFrameToTheLast) {
  constexpr int kLast = 50 * (AslFolder::kFrames - 1);
  for (const auto& [from, to] :
       {std::pair(-5, 115), {0, 120}, {20, 140}, {kLast - 110, kLast + 10}, {kLast - 120, kLast}}) {
    const AslFolder folder;
    cut(folder, kImuTable, from, to);
    expect_input_error([&] { open_asl(folder.root()); },
                       {kImuTable, "gap of 120.000 ms", stamp(from), stamp(to)});
  }
}

TEST(ImuGaps, BeforeTheFirstFrameAndAfterTheLastDoNotMatter) {
  constexpr int kLast = 50 * (AslFolder::kFrames - 1);
  for (const auto& [from, to] : {std::pair(-20, 0), {kLast, kLast + 20}}) {
    const AslFolder folder;
    cut(folder, kImuTable, from, to);
    EXPECT_NO_THROW(open_asl(folder.root())) << from;
  }
}

TEST(TruthGaps, AreRefusedInEveryInterval) {
  const AslFolder whole;
  EXPECT_NO_THROW(open_motion(whole.root()));
  constexpr int kLast = 50 * (AslFolder::kFrames - 1) + 50;
  for (const auto& [from, to] : {std::pair(-50, 60), {50, 160}, {kLast - 110, kLast}}) {
    const AslFolder folder;
    cut(folder, kTruthTable, from, to);
    expect_input_error([&] { open_motion(folder.root()); },
                       {kTruthTable, "no pose for 0.110 s", stamp(from), stamp(to)});
  }
}

}  // namespace
}  // namespace leviosim::traces
