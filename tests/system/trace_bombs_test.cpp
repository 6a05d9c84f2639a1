// Small work traces that stand for gigabytes or for years end as bad input: in every command that
// reads traces, and with little memory.
#include "tests/traces/trace_bombs.h"

#include <sys/resource.h>

#include "platform_models/loader/loader.h"
#include "sim/work/op.h"
#include "tests/support/run_program.h"
#include "traces/work_traces/work_memory.h"

namespace leviosim::tools {
namespace {

using namespace traces::testing;  // NOLINT: parts of traces, by which these tests are made
using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;

/// Programs that are started meanwhile have so much of address space. Sanitizers need terabytes of
/// it, so they go without.
class AddressSpace {
 public:
  explicit AddressSpace([[maybe_unused]] rlim_t bytes) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    ::getrlimit(RLIMIT_AS, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
#endif
  }
  ~AddressSpace() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    ::setrlimit(RLIMIT_AS, &before_);
#endif
  }
  AddressSpace(const AddressSpace&) = delete;
  AddressSpace& operator=(const AddressSpace&) = delete;

 private:
  rlimit before_{};
};

constexpr rlim_t kLittle = rlim_t{1} << 30;

TraceParts gap9_parts() {
  TraceParts parts;
  parts.platform_yaml = platform::to_yaml(platform::resolve_platform("gap9"));
  return parts;
}

class TraceBombs : public ::testing::TestWithParam<TraceBomb> {
 protected:
  TraceBombs() {
    outputs::write_file_atomically(folder_ / "bomb.trace", GetParam().file(gap9_parts()));
  }
  ProgramResult program(std::vector<std::string> words) const {
    const AddressSpace little(kLittle);
    return run_program(folder_.path(), std::move(words));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TempFolder folder_;
};

TEST_P(TraceBombs, AreRefused) {
  EXPECT_LT(std::filesystem::file_size(folder_ / "bomb.trace"), 60'000u);
  for (const char* action : {"check", "info"})
    expect_refused(program({"trace", action, path("bomb.trace")}),
                   {"bomb.trace", GetParam().refusal});
}

INSTANTIATE_TEST_SUITE_P(Kinds, TraceBombs, ::testing::ValuesIn(kTraceBombs),
                         [](const auto& kind) { return std::string(kind.param.name); });

/// Small traces whose frames fit the memory one by one, and would be decoded for long.
std::string trace_of_frames(TraceParts parts, std::size_t number, const std::string& steps) {
  constexpr std::size_t kMostOfASection = 60'000;
  parts.stamps = bytes({number, 2}) + times(number - 1, bytes({2}));
  parts.chunk_frames.clear();
  for (std::size_t left = number; left > 0; left -= parts.chunk_frames.back()) {
    const std::size_t some = std::min(left, kMostOfASection);
    parts.chunk_frames.push_back(some);
    parts.frames.push_back(section(some, kOneSeries, times(some, frame(list(1, stage(steps))))));
  }
  return parts.file();
}

/// The system ends a program that takes much longer or more than the 2 s and 300 MB of a small
/// file.
TEST(SlowTraces, AreRefusedSoon) {
  constexpr testing::ProgramLimits kLimits{.cpu_seconds = 5, .data_bytes = 300'000'000};
  const TempFolder folder;
  const std::string trace = (folder / "slow.trace").string();
  const std::string fork = bytes({1, 0, 0});
  for (const auto& [cores, frames, steps] :
       {std::tuple{8, 100'000, list(10, kSerialStep)}, std::tuple{8, 120'000, list(0, "")},
        std::tuple{8, 1000, list(1000, fork)}, std::tuple{1023, 1000, list(190, fork)}}) {
    TraceParts parts = gap9_parts();
    parts.cores = static_cast<std::uint64_t>(cores);
    const std::string file = trace_of_frames(parts, static_cast<std::size_t>(frames), steps);
    EXPECT_LT(file.size(), 130'000u);
    outputs::write_file_atomically(trace, file);
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"trace", "check", trace},
             {"replay", trace, "--quiet", "--out", (folder / "o").string()},
             {"compare", trace, trace, "--quiet"},
             {"whatif", trace, "cluster.clock=200MHz", "--quiet"}}) {
      if (cores > 8 && words[0] != "trace") continue;  // of which GAP9 has fewer
      const ProgramResult result = testing::Program(folder.path(), words, kLimits).wait();
      if (words[0] == "trace")  // which also reads the kernels, of which there are too few
        expect_refused(result, {"slow.trace"});
      else
        expect_refused(result, {"slow.trace, frames 0 to ", "--max-memory"});
      EXPECT_FALSE(std::filesystem::exists(folder / "o"));
    }
  }
}

class TraceLimitsOfPrograms : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& content) {
    outputs::write_file_atomically(folder_ / name, content);
  }
  ProgramResult program(std::vector<std::string> words) const {
    const AddressSpace little(kLittle);
    return run_program(folder_.path(), std::move(words));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TempFolder folder_;
};

/// One frame of so many steps, each of the work segment in which one counter is so high.
std::string heavy_trace(std::size_t steps, std::uint64_t count, work::Op op) {
  return trace_of_frame(gap9_parts(), list(1, constant_series(work::index(op), count)),
                        frame(list(1, stage(list(steps, kSerialStep)))), steps);
}

TEST_F(TraceLimitsOfPrograms, AreRaisedByMaxMemory) {
  write("large.trace", heavy_trace(400'000, 3, work::Op::IntAlu));
  expect_refused(program({"trace", "check", path("large.trace")}), {"--max-memory"});
  for (const char* size : {"600MiB", "0.6 GiB"}) {
    const ProgramResult result =
        program({"trace", "check", path("large.trace"), "--max-memory", size});
    EXPECT_EQ(result.status, 0) << result.err;
  }
  for (const char* wrong : {"2", "x", "0GiB", "nan GiB", "1kB", "2TiB", "3 cores"})
    expect_refused(program({"trace", "info", path("large.trace"), "--max-memory", wrong}),
                   {fmt::format("--max-memory '{}'", wrong), "GiB"});
}

TEST_F(TraceLimitsOfPrograms, HoldForReplaysAndLeaveNothing) {
  write("bomb.trace", heavy_trace(5'000'000, 3, work::Op::IntAlu));
  expect_refused(program({"replay", path("bomb.trace"), "--cores", "1", "--out", path("o")}),
                 {"bomb.trace", "steps of a stage", "--max-memory"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "o"));
}

TEST_F(TraceLimitsOfPrograms, HoldForSweeps) {
  write("large.trace", heavy_trace(400'000, 3, work::Op::IntAlu));
  write("plan.yaml", "base: { trace: large.trace }\npoints:\n  - grid: { cores: [1] }\n");
  const auto sweep = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"sweep", path("plan.yaml"), "--quiet", "--cache", path("cache")};
    words.insert(words.end(), more.begin(), more.end());
    return program(words);
  };
  ASSERT_EQ(sweep({"--out", path("little")}).status, 1);
  EXPECT_NE(base::read_text_file(folder_ / "little/sweep.csv").find("steps of a stage"),
            std::string::npos);
  ASSERT_EQ(sweep({"--out", path("more"), "--max-memory", "600MiB"}).status, 0);
  EXPECT_EQ(base::read_text_file(folder_ / "more/sweep.csv").find("steps of a stage"),
            std::string::npos);
  write("large.trace", trace_with(gap9_parts(), &TraceParts::names, list(9 * kMillion, text(""))));
  expect_refused(sweep({"--out", path("none")}), {"large.trace", "names", "--max-memory"});
}

/// Counts that the reader allows, but so many that the clocks of the chip cannot count the time.
TEST_F(TraceLimitsOfPrograms, WorkOfManyYearsIsRefused) {
  for (const work::Op op : {work::Op::IntAlu, work::Op::F64Div, work::Op::LoadL2}) {
    write("years.trace", heavy_trace(200'000, (std::uint64_t{1} << 40) - 1, op));
    expect_refused(
        program({"replay", path("years.trace"), "--cores", "1", "--quiet", "--out", path("o")}),
        {"simulated time", "clock"});
  }
}

/// Each transfer is short enough to be read, and so are the sums of their bytes and times.
TEST_F(TraceLimitsOfPrograms, TransfersOfManyDaysAreTimed) {
  const std::uint64_t most = traces::kMostTransferred - 1;
  for (const std::uint64_t kind : {3, 4}) {
    const std::string begun = kind == 4 ? bytes({kind, 0, most, 0}) : bytes({kind, 0, most});
    std::string steps = bytes({16'000}) + times(8'000, begun);
    for (std::uint64_t k = 0; k < 8'000; ++k)
      steps += kind == 4 ? bytes({5, k}) : bytes({kind, 1, most});
    write("days.trace", trace_of_frame(gap9_parts(), kNoSeries, frame(list(1, stage(steps)))));
    const ProgramResult result = program({"replay", path("days.trace"), "--cores", "1", "--quiet",
                                          "--out", path(fmt::format("out{}", kind))});
    EXPECT_EQ(result.status, 0) << result.err;
  }
}

/// The simulation has a bounded number of processes, and a background transfer is one.
TEST_F(TraceLimitsOfPrograms, BackgroundTransfersDoNotExhaustTheSimulation) {
  std::string steps = bytes({140'000}) + times(70'000, bytes({4, 0, 1 << 20, 0}));
  for (std::uint64_t k = 0; k < 70'000; ++k) steps += bytes({5, k});
  write("many.trace", trace_of_frame(gap9_parts(), kNoSeries, frame(list(1, stage(steps)))));
  const auto replay = [&](const std::string& platform) {
    return program({"replay", path("many.trace"), "--cores", "1", "--platform", platform, "--quiet",
                    "--out", path("o-" + platform)});
  };
  EXPECT_EQ(replay("gap9").status, 0) << "the DMA's queue lets the core wait";
  expect_refused(replay("cortex-m7"), {"background transfers"});
}

TEST_F(TraceLimitsOfPrograms, TransfersNeedTheMemoryThatTheyReach) {
  const std::string iteration = list(1, stage(list(1, bytes({3, 2, 64}))));
  write("external.trace",
        trace_of_frame(gap9_parts(), kNoSeries, frame_facts(4) + list(0, "") + list(1, iteration)));
  expect_refused(program({"replay", path("external.trace"), "--cores", "1", "--platform",
                          "cortex-m4f", "--quiet", "--out", path("o")}),
                 {"external memory"});
}

}  // namespace
}  // namespace leviosim::tools
