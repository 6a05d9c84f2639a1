// What a work trace may not say: more than fits the memory that it is given, and what no run does.
#include <random>

#include "tests/traces/test_folder.h"
#include "tests/traces/trace_bombs.h"
#include "tests/traces/work_trace_example.h"

namespace leviosim::traces {
namespace {

using namespace testing;  // NOLINT: parts of traces, by which these tests are made

constexpr std::int64_t kMiB = 1 << 20;

void expect_refused(const std::string& file, std::initializer_list<std::string> parts,
                    Bytes memory = kTraceMemory) {
  expect_input_error([&] { read_all(WorkTrace("t", file, memory)); }, parts);
}

/// @param segments  of work in the steps
std::string trace_of_stage(const std::string& steps, std::size_t segments = 0) {
  return trace_of_frame({}, kOneSeries, frame(list(1, stage(steps))), segments);
}

TEST(TraceLimits, PartsMakeATrace) {
  EXPECT_EQ(read_all(WorkTrace("t", trace_of_stage(list(3, kSerialStep), 3))), 1);
}

TEST(TraceLimits, AsksForTheMemoryAndSaysHowToAllowMore) {
  const std::string file = trace_of_stage(list(20'000, kSerialStep), 20'000);
  expect_refused(
      file,
      {"t, frames 0 to 0", "byte ", "steps of a stage (20000)", "MiB of memory", "--max-memory"},
      Bytes(4 * kMiB));
  EXPECT_EQ(read_all(WorkTrace("t", file, Bytes(64 * kMiB))), 1);
  expect_refused(file + std::string(5 * kMiB, 'x'), {"t: the file", "--max-memory"},
                 Bytes(4 * kMiB));
}

/// Frames are read into the same storage. One that is large in another stage than those before must
/// not add to what they took.
std::string frames_that_are_large_in_turn(std::size_t frames, std::size_t steps) {
  TraceParts parts;
  parts.chunk_frames = {frames};
  parts.stamps = bytes({frames, 2}) + times(frames - 1, bytes({2}));
  std::string all;
  for (std::size_t i = 0; i < frames; ++i) {
    all += frame_facts() + bytes({frames});
    for (std::size_t k = 0; k < frames; ++k)
      all += (i + k == 0 ? stage(list(steps, kSerialStep))
                         : bytes({0, 1}) + list(k == i ? steps : 0, kSerialStep));
  }
  parts.frames = {section(frames, kOneSeries, all)};
  std::mt19937 random;
  for (int i = 0; i < 30'000; ++i)  // a file that is as large as its frames ask for
    parts.platform_yaml += static_cast<char>(random());
  return parts.file();
}

TEST(TraceLimits, FramesDoNotAddUp) {
  const WorkTrace trace("t", frames_that_are_large_in_turn(40, 1000), Bytes(4 * kMiB));
  WorkFrames reader(trace);
  std::size_t most = 0;
  for (WorkFrame frame; reader.next(frame);) {
    std::size_t room = 0;
    for (const work::StageRun& stage : frame.front_end.stages)
      room += stage.steps.capacity() * sizeof(work::Step);
    most = std::max(most, room);
  }
  EXPECT_GT(most, std::size_t{500'000});
  EXPECT_LT(most, std::size_t{3 * kMiB});
}

TEST(TraceLimits, AllFramesTogetherAreBounded) {
  constexpr std::size_t kFrames = 1000;
  TraceParts parts;
  parts.cores = 1023;
  parts.chunk_frames = {kFrames};
  parts.stamps = bytes({kFrames, 2}) + times(kFrames - 1, bytes({2}));
  const std::string forks = frame(list(1, stage(list(2, bytes({1, 0, 0})))));
  parts.frames = {section(kFrames, kOneSeries, times(kFrames, forks))};
  const std::string file = parts.file();
  EXPECT_LT(file.size(), 5'000u);
  expect_input_error([&] { read_all(WorkTrace("t", file, Bytes(64 * kMiB)), false); },
                     {"t, frames 0 to 999", "stands for", "from a file of", "--max-memory"});
  EXPECT_EQ(read_all(WorkTrace("t", file, Bytes(4096 * kMiB)), false), static_cast<int>(kFrames));
}

/// Each of the most terms costs time, but no memory.
TEST(TraceLimits, SumsOfManyTermsAreBounded) {
  ByteWriter series;
  for (const std::size_t number : {std::size_t{0}, std::size_t{0}, work::kOpCount})
    series.whole(number);
  for (std::size_t sum = 0; sum < work::kOpCount; ++sum) {
    series.whole(sum);
    series.whole(work::kOpCount);
    for (std::size_t term = 0; term < work::kOpCount; ++term) series.append(bytes({term, 0}));
  }
  const auto steps = [&](std::size_t number) {
    return trace_of_frame({}, list(1, series.bytes()),
                          frame(list(1, stage(list(number, kSerialStep)))), number);
  };
  EXPECT_EQ(read_all(WorkTrace("t", steps(200))), 1);
  expect_refused(steps(100'000), {"stands for", "from a file of"});
}

TEST(TraceLimits, StagesOfOneNameAreManyOfDifferentNamesAreFew) {
  const auto with_stages = [](std::size_t number) {
    TraceParts parts;
    parts.names = list(number, text("x"));
    std::string stages = bytes({number}) + stage(list(0, ""));
    for (std::size_t k = 1; k < number; ++k) stages += bytes({k, 1, 0});
    return trace_of_frame(parts, kNoSeries, frame(stages));
  };
  EXPECT_EQ(read_all(WorkTrace("t", with_stages(kMostStages))), 1);
  expect_refused(with_stages(kMostStages + 1), {"more than 256 stages have different names"});
}

TEST(TraceLimits, BackgroundTransfersAreWaitedFor) {
  const std::string begin = bytes({4, 0, 8, 8});
  const auto wait = [](std::uint64_t number) { return bytes({5, number}); };
  const auto steps = [](std::initializer_list<std::string> all) {
    std::string content = bytes({all.size()});
    for (const std::string& step : all) content += step;
    return trace_of_stage(content);
  };
  EXPECT_EQ(read_all(WorkTrace("t", steps({begin, begin, wait(1), wait(0)}))), 1);
  expect_refused(steps({begin}), {"waits 0 times for 1 background"});
  expect_refused(steps({begin, begin, wait(0)}), {"waits 1 times for 2 background"});
  expect_refused(steps({begin, wait(0), wait(0)}), {"waits 2 times for 1 background"});
  expect_refused(steps({wait(0)}), {"the number of a background transfer is 0; expected none"});
  expect_refused(steps({wait(0), begin}), {"expected none"});
  expect_refused(steps({begin, wait(1)}), {"is 1; expected 0 to 0"});
  expect_refused(steps({bytes({4, 0, 8, 9}), wait(0)}),
                 {"bytes of a transfer that a larger memory would not need is 9; expected 0 to 8"});
}

TEST(TraceLimits, BytesOfMemoriesAndTransfersAreBounded) {
  const auto transfer = [](std::uint64_t bytes_moved) {
    return trace_of_stage(list(1, bytes({3, 0, bytes_moved})));
  };
  EXPECT_EQ(read_all(WorkTrace("t", transfer(kMostTransferred - 1))), 1);
  expect_refused(transfer(kMostTransferred), {"bytes of a transfer"});
  const auto memory = [](std::uint64_t size) {
    return trace_with({}, &TraceParts::memories, bytes({1}) + text("L2") + bytes({size, 0}));
  };
  EXPECT_EQ(read_all(WorkTrace("t", memory(kMostBytes - 1))), 1);
  expect_refused(memory(kMostBytes), {"bytes of memory"});
}

TEST(TraceLimits, AFrameSeesEarlierOnesOnly) {
  const auto two_frames = [](std::int64_t first, std::int64_t second) {
    TraceParts parts;
    parts.chunk_frames = {2};
    parts.stamps = bytes({2, 2, 2});
    parts.frames = {section(
        2, kNoSeries, frame_facts(0, first) + list(0, "") + frame_facts(0, second) + list(0, ""))};
    return parts.file();
  };
  EXPECT_EQ(read_all(WorkTrace("t", two_frames(-1, 0))), 2);
  expect_refused(two_frames(0, -1), {"result is of frame 0; expected an earlier one than 0"});
  expect_refused(two_frames(-1, 1), {"result is of frame 1; expected an earlier one than 1"});
  expect_refused(two_frames(-2, 0), {"of frame -2"});
}

TEST(TraceLimits, OffloadRegionsTogetherAreAtMostTheirSegment) {
  const auto with_calls = [](std::uint64_t eigen3, std::uint64_t solve) {
    TraceParts parts;
    parts.names = bytes({3}) + text("first") + text("eigen3") + text("solve");
    const std::string series = bytes({2}) + constant_series(0, eigen3) + constant_series(0, solve);
    const std::string calls = bytes({2, 1, 1, 1, 0, 2, 1, 1, 1});
    parts.offload = {text(series) + text("") + calls};
    return trace_of_frame(parts, list(1, constant_series(0, 10)),
                          frame(list(1, stage(list(1, kSerialStep)))));
  };
  EXPECT_EQ(read_all(WorkTrace("t", with_calls(4, 6))), 1);
  expect_refused(with_calls(11, 0), {"count more than their work segment"});
  expect_refused(with_calls(4, 7),
                 {"offload regions of frames 0 to 0", "more than their work segment"});
}

TEST(TraceLimits, TheSizeOfASectionIsThatOfItsContent) {
  const std::string stored = packed_section("x", 1).substr(12);
  ByteWriter head;
  head.u32(static_cast<std::uint32_t>(stored.size()));
  head.u32(200'000'000);
  head.u32(crc_of(head.bytes(), stored));
  const std::string file = file_head(kWorkTraceFile) + head.take() + stored;
  // Compared before anything is allocated, so even with little memory it is not that which lacks.
  expect_refused(file, {"byte 16", "holds 1 bytes; expected 200000000"}, Bytes(kMiB));
}

}  // namespace
}  // namespace leviosim::traces
