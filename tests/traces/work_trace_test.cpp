// A work trace gives back what was recorded, and everything else is refused.
#include "traces/work_traces/work_trace.h"
#include "tests/support/paths.h"

#include "tests/traces/test_folder.h"
#include "tests/traces/work_trace_example.h"
#include "traces/datasets/rng.h"
#include "traces/work_traces/plain_file.h"

namespace leviosim::traces {
namespace {

using testing::example_frame;
using testing::example_trace;
using testing::expect_input_error;
using testing::read_all;

constexpr int kHeadBytes = 16;

/// The container around other contents, with checksums that are right.
std::string trace_of(const std::vector<std::string>& contents,
                     std::uint32_t version = kWorkTraceFile.version) {
  std::string file = file_head({"LEVIOWT\n", "a work trace", version});
  for (const std::string& content : contents) file += packed_section(content, 1);
  return file;
}

std::vector<std::string> contents_of(const std::string& trace) {
  std::vector<std::string> contents;
  MemoryBudget budget(kTraceMemory);
  for (const Section& section : sections_of(kWorkTraceFile, "t", trace))
    contents.push_back(unpacked(section, "t", budget));
  return contents;
}

class FramesOfTraces : public ::testing::TestWithParam<int> {};

TEST_P(FramesOfTraces, ComeBackAsTheyWere) {
  const WorkTrace trace("example", example_trace(GetParam()));
  ASSERT_EQ(trace.frames(), GetParam());
  WorkFrames reader(trace);
  WorkFrame frame;  // used again for every frame, as a replay does
  for (int i = 0; i < GetParam(); ++i) {
    ASSERT_TRUE(reader.next(frame));
    testing::expect_equal(frame, example_frame(i));
  }
  EXPECT_FALSE(reader.next(frame));
}

// A chunk has 32 frames.
INSTANTIATE_TEST_SUITE_P(Numbers, FramesOfTraces, ::testing::Values(0, 1, 2, 32, 33, 70));

TEST(WorkTrace, KeepsWhatIsTheSameForAllFrames) {
  const WorkTrace trace("example", example_trace(3));
  const WorkTraceInfo& info = trace.info();
  const WorkTraceInfo expected = testing::example_info();
  EXPECT_EQ(info.program, expected.program);
  EXPECT_EQ(info.data, expected.data);
  EXPECT_EQ(info.platform_yaml, expected.platform_yaml);
  EXPECT_EQ(info.cores, 3);
  EXPECT_EQ(info.frame_period_ns, expected.frame_period_ns);
  ASSERT_EQ(info.stages.size(), 2u);
  EXPECT_EQ(info.stages[1].name, "iteration");
  EXPECT_TRUE(info.stages[1].on_controller);
  ASSERT_EQ(info.l2.size(), 1u);
  EXPECT_EQ(info.l2[0].blocks.at(0).name, "poses");
  EXPECT_EQ(info.ate->translation.median, 0.1);
  EXPECT_EQ(info.ate->size_ratio, 1.5);
  EXPECT_EQ(info.ate->located_rmse_m, 0.2);
  EXPECT_FALSE(info.ate->longest_gap_s.has_value());
  EXPECT_EQ(info.inputs, expected.inputs);
  EXPECT_EQ(info.stamps_ns.at(2), example_frame(2).t_ns);
}

TEST(WorkTrace, SameFramesSameBytes) { EXPECT_EQ(example_trace(40), example_trace(40)); }

TEST(WorkTrace, ReadersOfOneTraceDoNotMeet) {
  const WorkTrace trace("example", example_trace(40));
  WorkFrames a(trace);
  WorkFrames b(trace);
  WorkFrame frame;
  for (int i = 0; i < 35; ++i) a.next(frame);
  ASSERT_TRUE(b.next(frame));
  testing::expect_equal(frame, example_frame(0));
  ASSERT_TRUE(a.next(frame));
  testing::expect_equal(frame, example_frame(35));
}

TEST(WorkTrace, AReaderSkipsToAFrame) {
  const WorkTrace trace("example", example_trace(70));
  for (const int number : {0, 1, 31, 32, 40, 69}) {
    WorkFrames reader(trace);
    reader.skip_to(number);
    WorkFrame frame;
    for (int i = number; i < 70; ++i) {
      ASSERT_TRUE(reader.next(frame));
      testing::expect_equal(frame, example_frame(i));
    }
    EXPECT_FALSE(reader.next(frame));
  }
  WorkFrames beyond(trace);
  beyond.skip_to(70);
  WorkFrame frame;
  EXPECT_FALSE(beyond.next(frame));
}

/// As interactive pages hold it: all that is compressed is plain, under checksums that are right.
TEST(WorkTrace, IsWrittenWithoutCompression) {
  const std::string packed = example_trace(40);
  const std::string plain = plain_file(WorkTrace("t", packed), {});
  std::vector<std::string> contents;
  for (const Section& section : sections_of(kWorkTraceFile, "t", plain)) {
    EXPECT_EQ(section.stored.size(), section.content_size);
    contents.emplace_back(section.stored);
  }
  EXPECT_EQ(contents, contents_of(packed));
}

template <class Change>
void for_each_segment(WorkFrame& frame, Change change) {
  std::vector<work::Job*> jobs = {&frame.front_end};
  for (work::Job& iteration : frame.iterations) jobs.push_back(&iteration);
  for (work::Job* job : jobs)
    for (work::StageRun& stage : job->stages)
      for (work::Step& step : stage.steps) {
        if (auto* serial = std::get_if<work::Serial>(&step)) change(serial->counts);
        if (auto* fork = std::get_if<work::Fork>(&step))
          for (work::Segment& share : fork->shares) change(share);
      }
}

std::filesystem::path golden_file(const std::string& name) {
  return leviosim::tests::source_folder() / "tests/traces/golden" / name;
}

TEST(WorkTrace, KeepsFactsOfAnyNameAndNumber) {
  WorkTraceWriter writer(3);
  WorkTraceInfo info = testing::example_info();
  info.facts = {"restarts", "of another program"};
  WorkFrame frame = example_frame(0);
  frame.facts = {7, 0};
  writer.add(frame);
  const std::string bytes = writer.finish(info);
  const WorkTrace trace("facts", bytes);
  EXPECT_EQ(trace.info().facts, info.facts);
  WorkFrame read;
  ASSERT_TRUE(WorkFrames(trace).next(read));
  EXPECT_EQ(read.facts, frame.facts);

  std::vector<std::string> contents = contents_of(bytes);
  const std::size_t at = contents.back().find("\x02\x08restarts");
  ASSERT_NE(at, std::string::npos);
  contents.back()[at] = 65;
  expect_input_error([&] { WorkTrace("many", trace_of(contents)); }, {"facts of frames", "65"});
}

TEST_P(FramesOfTraces, ComeBackWithTheirKernels) {
  const WorkTrace trace("example", testing::example_trace_with_offload(GetParam()));
  WorkFrames reader(trace, true);
  WorkFrames without(trace);
  WorkFrame frame;
  WorkFrame plain;
  for (int i = 0; i < GetParam(); ++i) {
    ASSERT_TRUE(reader.next(frame));
    testing::expect_equal(frame, testing::example_frame_with_offload(i));
    ASSERT_TRUE(without.next(plain));
    testing::expect_equal(plain, example_frame(i));
  }
  EXPECT_FALSE(reader.next(frame));
}

TEST(WorkTrace, RefusesKernelsThatCannotBe) {
  const auto refuse = [](const char* from, const char* to,
                         std::initializer_list<std::string> parts) {
    std::vector<std::string> contents = contents_of(testing::example_trace_with_offload(2));
    const std::size_t at = contents.back().find(from);
    ASSERT_NE(at, std::string::npos);
    contents.back().replace(at, std::string(from).size(), to);
    expect_input_error([&] { read_all(WorkTrace("t", trace_of(contents))); }, parts);
  };
  refuse("eigen12", "eigen17", {"offload regions of frames 0 to 1", "'eigen17' is no kernel"});
  // Order of the kinds: 12 after Hamming is twice the same or out of order.
  refuse("eigen12", "hamming", {"comes twice"});
}

TEST(WorkTrace, KeepsWhichForksAreAlignedOnOneCore) {
  WorkFrame written = testing::example_frame(0);
  for (work::Step& step : written.front_end.stages.at(0).steps)
    if (auto* fork = std::get_if<work::Fork>(&step))
      fork->aligned_on_one_core = !fork->master_takes_part;
  WorkTraceWriter writer(3);
  writer.add(written);
  const WorkTrace trace("example", writer.finish(testing::example_info()));
  WorkFrame read;
  ASSERT_TRUE(WorkFrames(trace, true).next(read));
  testing::expect_equal(read, written);
}

/// What readers for one instruction set get, but for the compiled work of others.
void expect_same(const WorkTrace& expected, const WorkTrace& trace, work::CompiledFor code) {
  WorkFrames all(expected, true);
  WorkFrames one(trace, true, code);
  WorkFrame a, b;
  const auto keep_only = [code](work::Segment& segment) {
    const auto own = work::compiled_of(segment.compiled, code);
    segment.compiled = {};
    work::set_compiled(segment.compiled, code, own);
  };
  while (all.next(a)) {
    ASSERT_TRUE(one.next(b));
    for_each_segment(a, keep_only);
    for_each_segment(b, keep_only);
    testing::expect_equal(a, b);
  }
  EXPECT_FALSE(one.next(b));
}

TEST(WorkTrace, GivesTheCompiledWorkOfOneInstructionSetAlone) {
  const std::string packed = testing::example_trace_with_offload(40);
  const WorkTrace trace("example", packed);
  const std::string plain = plain_file(trace, {});
  for (const auto code :
       {work::CompiledFor::Rv32imfc, work::CompiledFor::Armv6, work::CompiledFor::Rv32imfcXpulp}) {
    expect_same(trace, trace, code);
    // And so do pages, which keep no other.
    const std::string part = plain_file(trace, code);
    EXPECT_LT(part.size(), plain.size());
    std::vector<std::string> contents;
    for (const Section& section : sections_of(kWorkTraceFile, "t", part))
      contents.emplace_back(section.stored);
    expect_same(trace, WorkTrace("part", trace_of(contents)), code);
  }
}

/// Not the compressed bytes are compared, which another version of zstd may choose otherwise. With
/// LEVIOSIM_RENEW_GOLDEN the file is written anew: for a version that no release has written yet.
TEST(WorkTrace, WritesTheContentOfItsVersion) {
  if (std::getenv("LEVIOSIM_RENEW_GOLDEN") != nullptr)
    std::ofstream(golden_file("version_10.trace"), std::ios::binary)
        << testing::example_trace_with_offload(5);
  const std::string golden = base::read_text_file(golden_file("version_10.trace"));
  EXPECT_EQ(contents_of(golden), contents_of(testing::example_trace_with_offload(5)));
}

TEST(WorkTrace, EveryTruncationIsRefused) {
  const std::string whole = example_trace(40);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(WorkTrace("cut", whole.substr(0, size)), InputError) << size;
  EXPECT_THROW(WorkTrace("longer", whole + 'x'), InputError);
  EXPECT_THROW(WorkTrace("twice", whole + whole.substr(kHeadBytes)), InputError);
}

TEST(WorkTrace, EveryFlippedBitIsRefused) {
  const std::string whole = example_trace(40);
  Rng rng(7);
  for (std::size_t byte = 0; byte < whole.size(); ++byte) {
    std::string flipped = whole;
    flipped[byte] = static_cast<char>(flipped[byte] ^ (1 << (rng.next() % 8)));
    EXPECT_THROW(WorkTrace("flipped", flipped), InputError) << byte;
  }
}

/// Whatever a section holds: with right checksums, damage is found while reading or not at all, but
/// never ends in anything else.
TEST(WorkTrace, DamagedContentIsReadOrRefused) {
  const std::vector<std::string> whole = contents_of(testing::example_trace_with_offload(5));
  Rng rng(11);
  int refused = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::vector<std::string> contents = whole;
    std::string& content = contents[rng.next() % contents.size()];
    content[rng.next() % content.size()] = static_cast<char>(rng.next());
    try {
      read_all(WorkTrace("damaged", trace_of(contents)));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 400);
}

TEST(WorkTrace, ContentThatIsCutIsRefused) {
  const std::vector<std::string> whole = contents_of(testing::example_trace_with_offload(5));
  for (std::size_t section = 0; section < whole.size(); ++section)
    for (std::size_t size = 0; size < whole[section].size(); ++size) {
      std::vector<std::string> contents = whole;
      contents[section].resize(size);
      EXPECT_THROW(read_all(WorkTrace("cut", trace_of(contents))), InputError)
          << section << " " << size;
    }
}

TEST(WorkTrace, SaysWhatIsWrongAndWhere) {
  const std::string whole = example_trace(5);
  const auto refuse = [](std::string bytes, std::initializer_list<std::string> parts) {
    expect_input_error([&] { read_all(WorkTrace("out/work.trace", std::move(bytes))); }, parts);
  };
  refuse("", {"out/work.trace", "is not a work trace", "LEVIOWT"});
  refuse("frame,t_ns,source\n", {"is not a work trace"});
  refuse(whole.substr(0, 10), {"out/work.trace, byte 10", "truncated"});
  refuse(whole.substr(0, kHeadBytes), {"byte 16", "truncated"});
  refuse(whole.substr(0, whole.size() - 1), {"truncated", "section at byte"});
  std::string damaged = whole;
  damaged[kHeadBytes + 20] ^= 1;
  refuse(damaged, {"byte 16", "checksum", "damaged"});
  constexpr std::uint32_t kVersion = kWorkTraceFile.version;
  refuse(trace_of(contents_of(whole), kVersion + 1), {"version 11", "reads version 10", "newer"});
  refuse(trace_of(contents_of(whole), kVersion - 1), {"version 9", "reads version 10", "again"});
  std::string version = whole;
  version[8] = 1;
  refuse(version, {"byte 8", "checksum"});
  refuse(trace_of({contents_of(whole).back()}), {"0 sections of frames", "expected 2"});
  refuse(trace_of({contents_of(whole)[0], contents_of(whole)[1]}),
         {"before its summary", "truncated"});
  std::vector<std::string> contents = contents_of(whole);
  contents[0] += 'x';
  refuse(trace_of(contents), {"frames 0 to 4", "expected the end"});
}

TEST(WorkTrace, RefusesOperationsItDoesNotKnow) {
  std::vector<std::string> contents = contents_of(example_trace(2));
  const std::size_t at = contents.back().find("f32_fma");
  ASSERT_NE(at, std::string::npos);
  contents.back().replace(at, 7, "f32_fmx");
  expect_input_error([&] { WorkTrace("t", trace_of(contents)); }, {"operation 'f32_fmx'"});
}

TEST(WorkTrace, RefusesInstructionSetsItDoesNotKnow) {
  std::vector<std::string> contents = contents_of(example_trace(2));
  const std::size_t at = contents.back().find("thumb2");
  ASSERT_NE(at, std::string::npos);
  contents.back().replace(at, 6, "thumb3");
  expect_input_error([&] { WorkTrace("t", trace_of(contents)); }, {"instruction set 'thumb3'"});
}

}  // namespace
}  // namespace leviosim::traces
