// leviosim sweep as users meet it: killed, resumed, in shares, merged, by Slurm's and GNU
// parallel's scripts, always with the same bytes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/sweep/pareto_front.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::Program;
using testing::ProgramResult;
using testing::run_program;

/// A folder with one second of flight, its trace on gap9, and a plan of nine points over it.
class SweepCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / fmt::format("leviosim-{}-sweep", ::getpid());
    fs::create_directories(folder_);
    traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 1, .texel_m = 0.05});
    const ProgramResult recorded =
        run_program(folder_, {"run", "--platform", "gap9", "--data", path("flight"), "--record",
                              "--out", path("recorded"), "--quiet"});
    ASSERT_EQ(recorded.status, 0) << recorded.err;
    outputs::write_file_atomically(folder_ / "plan.yaml",
                                   "base: { trace: recorded }\n"
                                   "points:\n"
                                   "  - grid:\n"
                                   "      platform.cluster.clock: [200, 370]\n"
                                   "      platform.cluster.fpu.units: [1, 4]\n"
                                   "      platform.cluster.dma.bytes_per_cycle: [4, 8]\n"
                                   "  - list:\n"
                                   "      - { platform.cluster.l1.size: 64KiB }\n");
    const ProgramResult whole = sweep({"--out", path("whole")}, "whole");
    ASSERT_EQ(whole.status, 1) << "L1 is too small at a point" << whole.err;
    whole_out_ = whole.out;
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string path(const std::string& name) { return (folder_ / name).string(); }
  /// With a cache of its own by this name.
  static std::vector<std::string> words(std::vector<std::string> more, const std::string& cache) {
    std::vector<std::string> all{"sweep", path("plan.yaml"), "--quiet", "--cache",
                                 path("cache-" + cache)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  static ProgramResult sweep(std::vector<std::string> more, const std::string& cache) {
    return run_program(folder_, words(std::move(more), cache));
  }
  static std::string csv(const std::string& folder) {
    return base::read_text_file(folder_ / folder / kSweepCsv);
  }
  static int shell(const std::string& script) {
    const std::string line = fmt::format("cd '{}' && LEVIOSIM='{}' {} >shell.txt 2>&1", path(""),
                                         leviosim::tests::program_path(), script);
    const int status = std::system(line.c_str());  // NOLINT: the command is the test's own
    return WEXITSTATUS(status);
  }
  static std::string example(const std::string& name) {
    return fmt::format("'{}/tools/app/study/sweep/examples/{}'",
                       leviosim::tests::source_folder().string(), name);
  }

  static fs::path folder_;
  static std::string whole_out_;
};
fs::path SweepCommand::folder_;
std::string SweepCommand::whole_out_;

/// By its first points, whoever looks at stderr; of nothing that takes no time.
TEST_F(SweepCommand, SaysHowLongItTakesAsItBegins) {
  outputs::write_file_atomically(folder_ / "many.yaml",
                                 "base: { trace: recorded }\npoints:\n  - grid:\n"
                                 "      platform.cluster.fpu.units: [1, 2, 4, 8]\n"
                                 "      platform.cluster.dma.bytes_per_cycle: [2, 4, 8]\n");
  const auto swept = [&](const std::string& out) {
    return run_program(folder_, {"sweep", path("many.yaml"), "--jobs", "2", "--cache",
                                 path("cache-many"), "--out", path(out)});
  };
  const ProgramResult first = swept("many");
  EXPECT_EQ(first.status, 0) << first.err;
  EXPECT_TRUE(std::regex_search(
      first.err, std::regex(R"(12 points, [0-9.e-]+ s each: about [0-9.e-]+ s on 2 cores\n)")))
      << first.err;
  EXPECT_EQ(swept("again").err.find("each: about"), std::string::npos);
  EXPECT_EQ(sweep({"--out", path("few")}, "few").err, "");
}

TEST_F(SweepCommand, GivesTheFiguresOfReplaysAndRunsNothingTwice) {
  const std::string text = csv("whole");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 9);
  EXPECT_NE(text.find("\n9,failed,"), std::string::npos);
  EXPECT_NE(text.find("L1"), std::string::npos);
  EXPECT_NE(whole_out_.find("9 computed"), std::string::npos) << whole_out_;
  EXPECT_NE(whole_out_.find("Pareto front"), std::string::npos);

  const traces::WorkTrace trace(folder_ / "recorded" / "work.trace");
  RunRequest request;
  request.platform = recorded_platform(
      trace, {"cluster.clock=200MHz", "cluster.fpu.units=1", "cluster.dma.bytes_per_cycle=8"});
  const Replay there = replay(trace, request, [](const Progress&) {});
  double sum_ns = 0;
  for (const FrameResult& f : there.run.frames)
    sum_ns += static_cast<double>(f.end_ns - f.start_ns);
  {
    SweepStore store(folder_ / "whole");
    EXPECT_GT(pareto_front(store.outcomes()).size(), 0u);
    ASSERT_EQ(
        store.settings_of(2).find("platform.cluster.clock=200MHz platform.cluster.fpu.units=1"),
        0u);
    EXPECT_DOUBLE_EQ(store.outcomes().at(1).objectives[0].value(),
                     sum_ns * 1e-6 / static_cast<double>(there.run.frames.size()));
  }
  const ProgramResult again = sweep({"--out", path("whole")}, "empty");
  EXPECT_NE(again.out.find("0 computed"), std::string::npos) << again.out;
  EXPECT_NE(again.out.find("9 done before"), std::string::npos);
  const ProgramResult elsewhere = sweep({"--out", path("elsewhere")}, "whole");
  EXPECT_NE(elsewhere.out.find("8 found in the cache"), std::string::npos) << elsewhere.out;
  EXPECT_EQ(csv("elsewhere"), csv("whole"));  // what failed is tried again
}

TEST_F(SweepCommand, HoldsEveryPointAgainstABudget) {
  outputs::write_file_atomically(folder_ / "budgets.yaml",
                                 "budgets:\n"
                                 "  - limits:\n"
                                 "      - frame latency p99 <= 1 s\n"
                                 "      - stage: feature*\n"
                                 "        limit: cycles <= +5 %\n");
  const ProgramResult held =
      sweep({"--out", path("held"), "--budget", path("budgets.yaml")}, "whole");
  EXPECT_EQ(held.status, 1) << held.err;
  EXPECT_EQ(held.err, "");
  // All that run are near point 1. Two are too slow for the camera. Point 9 cannot run.
  for (const char* part : {"9 points against ", ": 3 do not meet it", "cannot run"})
    EXPECT_NE(held.out.find(part), std::string::npos) << part << " is not in:\n" << held.out;

  outputs::write_file_atomically(folder_ / "budgets.yaml",
                                 "budgets:\n  - limits: [frame latency p99 <= 1 ns]\n");
  const ProgramResult again =
      sweep({"--out", path("held"), "--budget", path("budgets.yaml")}, "whole");
  EXPECT_EQ(again.status, 1);
  EXPECT_NE(again.out.find(": 9 do not meet it"), std::string::npos) << again.out;
  EXPECT_NE(again.out.find("frame latency p99 <= 1 ns"), std::string::npos) << again.out;
  testing::expect_refused(
      sweep({"--out", path("never"), "--budget", path("nowhere.yaml")}, "whole"), {"nowhere.yaml"});
}

TEST_F(SweepCommand, AFinishedSweepIsHeldAgainstABudget) {
  outputs::write_file_atomically(folder_ / "budgets.yaml",
                                 "budgets:\n  - limits: [L1 peak <= 1 MB]\n");
  const ProgramResult late =
      sweep({"--out", path("whole"), "--budget", path("budgets.yaml")}, "whole");
  EXPECT_EQ(late.status, 1) << late.err;  // two points are too slow, and one cannot run
  for (const char* part : {"9 done before", "9 points against ", ": 3 do not meet it"})
    EXPECT_NE(late.out.find(part), std::string::npos) << part << " is not in:\n" << late.out;
}

TEST_F(SweepCommand, GoesOnAfterBeingKilledAtAnyMoment) {
  traces::Rng rng(11);
  for (int trial = 0; trial < 3; ++trial) {
    const std::string name = fmt::format("killed-{}", trial);
    for (int kill = 0; kill < 2; ++kill) {
      Program program(folder_, words({"--out", path(name), "--jobs", "2"}, name));
      std::this_thread::sleep_for(std::chrono::milliseconds(60 + rng.below(200)));
      program.send(SIGKILL);
      program.wait();
    }
    const ProgramResult rest = sweep({"--out", path(name)}, name);
    ASSERT_EQ(rest.status, 1) << rest.err;
    EXPECT_EQ(csv(name), csv("whole"));
  }
}

TEST_F(SweepCommand, SharesMergedAreOneRunAndNothingElseIsMerged) {
  for (const char* share : {"1/3", "2/3", "3/3"})
    ASSERT_LE(
        sweep({"--out", path(fmt::format("share-{:.1}", share)), "--shard", share}, "s").status, 1);
  EXPECT_NE(csv("share-1"), csv("whole"));
  const ProgramResult merged =
      run_program(folder_, {"sweep", "--merge", path("merged"), path("share-3"), path("share-1"),
                            path("share-2"), path("share-1")});
  ASSERT_EQ(merged.status, 0) << merged.err;
  EXPECT_EQ(csv("merged"), csv("whole"));
  // Lines one behind the other are a sweep, too.
  fs::create_directory(folder_ / "joined");
  std::ofstream joined(folder_ / "joined" / kSweepFile, std::ios::binary);
  for (const char* share : {"share-2", "share-1", "share-3", "share-2"})
    joined << base::read_text_file(folder_ / share / kSweepFile);
  joined.close();
  const ProgramResult of_joined =
      run_program(folder_, {"sweep", "--merge", path("from-joined"), path("joined")});
  ASSERT_EQ(of_joined.status, 0) << of_joined.err;
  EXPECT_EQ(csv("from-joined"), csv("whole"));
  for (const char* point : {"9", "2"})
    ASSERT_LE(sweep({"--out", path("singly"), "--point", point}, "s").status, 1);
  EXPECT_EQ(SweepStore(folder_ / "singly").finished(), (std::set<int>{2, 9}));

  outputs::write_file_atomically(folder_ / "other.yaml",
                                 "base: { trace: recorded }\n"
                                 "points: { grid: { platform.cluster.clock: [200] } }\n");
  ASSERT_EQ(run_program(folder_, {"sweep", path("other.yaml"), "--out", path("other"), "--quiet",
                                  "--cache", path("cache-other")})
                .status,
            0);
  testing::expect_refused(
      run_program(folder_, {"sweep", "--merge", path("mixed"), path("whole"), path("other")}),
      {"other", "another plan"});
  testing::expect_refused(sweep({"--out", path("other")}, "other"), {"another plan", "--force"});
  testing::expect_refused(
      run_program(folder_, {"sweep", "--merge", path("mixed"), path("nowhere")}),
      {"nowhere", "points.jsonl"});
}

TEST_F(SweepCommand, ListsItsPointsAndRefusesWhatItCannotDo) {
  const ProgramResult list = sweep({"--list"}, "list");
  EXPECT_EQ(std::count(list.out.begin(), list.out.end(), '\n'), 9);
  EXPECT_EQ(list.out.find("1\tplatform.cluster.clock=200MHz"), 0u) << list.out;

  testing::expect_refused(sweep({"--out", path("x"), "--shard", "4/3"}, "x"), {"--shard '4'"});
  testing::expect_refused(sweep({"--out", path("x"), "--point", "10"}, "x"), {"--point '10'"});
  testing::expect_refused(sweep({"--out", path("flight")}, "x"), {"something other"});
  testing::expect_refused(sweep({}, "x"), {"--out"});
  outputs::write_file_atomically(folder_ / "bad.yaml",
                                 "base: { trace: recorded }\n"
                                 "points: { grid: { workload.window: [4] } }\n");
  testing::expect_refused(run_program(folder_, {"sweep", path("bad.yaml"), "--out", path("x")}),
                          {"bad.yaml:2", "workload.window", "recorded work", "data"});
  EXPECT_FALSE(fs::exists(folder_ / "x"));
}

TEST_F(SweepCommand, RefusesAMillionPointsBeforeAnyIsMade) {
  outputs::write_file_atomically(folder_ / "million.yaml",
                                 "base: { trace: recorded }\n"
                                 "points: { random: { number: 1000000, over: {\n"
                                 "  platform.cluster.clock: { from: 100, to: 370 } } } }\n");
  const ProgramResult refused = run_program(folder_, {"sweep", path("million.yaml"), "--list"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.out, "");
  EXPECT_NE(refused.err.find("more than 100000 points"), std::string::npos) << refused.err;
}

TEST_F(SweepCommand, LivePointsHaveTheAccuracyOfTheirRun) {
  outputs::write_file_atomically(folder_ / "live.yaml",
                                 "base: { data: flight, platform: gap9, frames: '0:6' }\n"
                                 "points: { grid: { workload.window: [4, 6] } }\n");
  const ProgramResult live =
      run_program(folder_, {"sweep", path("live.yaml"), "--out", path("live"), "--quiet", "--cache",
                            path("cache-live")});
  ASSERT_EQ(live.status, 0) << live.err;
  RunRequest request;
  request.data = path("flight");
  request.platform = platform::resolve_platform("gap9");
  request.frames = traces::FrameRange{0, 6};
  request.workload = {{vio::find_parameter("workload.window"), 4}};
  const RunResult run = simulate(request, [](const Progress&) {});
  {
    SweepStore store(folder_ / "live");
    ASSERT_TRUE(run.ate);
    EXPECT_NEAR(store.outcomes().at(0).objectives[3].value(), run.ate->translation.rmse, 1e-9);
  }
  const ProgramResult compared =
      run_program(folder_, {"compare", path("live:1"), path("live:2"), "--quiet"});
  ASSERT_EQ(compared.status, 0) << compared.err;
  for (const char* part : {"B  levio on gap9, workload.window=6, 8 cores", "live:2",
                           "note: workload parameters: workload.window=4 in A"})
    EXPECT_NE(compared.out.find(part), std::string::npos) << compared.out;
}

/// On a few frames of the synthetic flight, with one seed; and their recording lies beside the
/// repository.
TEST_F(SweepCommand, AllPointsOfTheExamplesCanRun) {
  const fs::path root = leviosim::tests::source_folder();
  int plans = 0;
  for (const fs::directory_entry& file :
       fs::directory_iterator(root / "tools/app/study/sweep/examples")) {
    if (file.path().extension() != ".yaml") continue;
    ++plans;
    std::string text = base::read_text_file(file.path());
    std::smatch data;
    ASSERT_TRUE(std::regex_search(text, data, std::regex("data: (.*)\n"))) << file.path();
    EXPECT_EQ((file.path().parent_path() / data[1].str()).lexically_normal(),
              (root.parent_path() / "shared/data/euroc/MH_01_easy_t05_t20").lexically_normal());
    text.replace(static_cast<std::size_t>(data.position()), static_cast<std::size_t>(data.length()),
                 "data: synthetic\n  frames: '20:34'\n");
    text = std::regex_replace(text, std::regex(R"(seed: \[1, [0-9, ]*\])"), "seed: [1]");
    const std::string plan = path(file.path().filename().string());
    outputs::write_file_atomically(plan, text);
    const ProgramResult swept =
        run_program(folder_, {"sweep", plan, "--out", path("of-" + file.path().stem().string()),
                              "--quiet", "--cache", path("cache-examples")});
    EXPECT_EQ(swept.status, 0) << swept.err;
    EXPECT_NE(swept.out.find("is the fastest"), std::string::npos) << swept.out;
    EXPECT_EQ(swept.out.find("cannot run"), std::string::npos) << swept.out;
  }
  EXPECT_GE(plans, 2);
}

/// Points are compared as the replays that they stand for are.
/// To nine digits: a mean over milliseconds is not the last bit of one over nanoseconds.
std::string rounded_numbers(const std::string& csv) {
  std::string text;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      text += (cell.empty() || *end != '\0' ? cell : fmt::format("{:.9g}", value)) + ',';
    }
    text += '\n';
  }
  return text;
}

TEST_F(SweepCommand, PointsAreComparedLikeReplaysOfTheirChips) {
  const auto compare = [](std::vector<std::string> words) {
    words.insert(words.begin(), "compare");
    words.emplace_back("--quiet");
    return run_program(folder_, words);
  };
  for (const char* units : {"1", "4"}) {
    const ProgramResult replayed = run_program(
        folder_, {"replay", path("recorded"), "-p", "cluster.clock=200MHz", "-p",
                  fmt::format("cluster.fpu.units={}", units), "-p", "cluster.dma.bytes_per_cycle=4",
                  "--quiet", "--out", path(fmt::format("units-{}", units))});
    ASSERT_EQ(replayed.status, 0) << replayed.err;
  }
  const std::string a = path("whole:1"), b = path("whole:3");
  const ProgramResult points = compare({a, b, "--format", "csv"});
  ASSERT_EQ(points.status, 0) << points.err;
  const ProgramResult folders = compare({path("units-1"), path("units-4"), "--format", "csv"});
  EXPECT_EQ(rounded_numbers(points.out), rounded_numbers(folders.out));
  for (const char* format : {"text", "markdown", "json"}) {
    const ProgramResult result =
        compare({a, b, "--format", format, "--force", "--report", path("points.html")});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("cluster.fpu.units=4"), std::string::npos) << result.out;
    EXPECT_NE(base::read_text_file(folder_ / "points.html").find("whole:3"), std::string::npos);
  }
  EXPECT_EQ(compare({path("units-1"), b}).status, 0);

  testing::expect_refused(compare({a, path("whole:10")}), {"whole:10", "from 1 to 9"});
  testing::expect_refused(compare({a, path("whole:x")}), {"whole:x", "from 1 to 9"});
  testing::expect_refused(compare({a, path("whole")}), {"is a sweep", "whole:1 to ", "whole:9"});
  testing::expect_refused(compare({a, path("nowhere:1")}), {"nowhere:1", "does not exist"});
  testing::expect_refused(compare({a}), {"only", "whole:1"});
  testing::expect_refused(compare({a, b, "-p", "cluster.l1.banks=8"}), {"whole:1", "has its chip"});
  testing::expect_refused(compare({a, path("whole:9")}), {"L1"});  // too small
}

TEST_F(SweepCommand, PointsMoveWithTheirPlanAndAreRefusedAfterItsTraceHasChanged) {
  fs::create_directory(folder_ / "before");
  fs::copy(folder_ / "recorded", folder_ / "before/recorded");
  outputs::write_file_atomically(folder_ / "before/plan.yaml",
                                 "base: { trace: recorded }\n"
                                 "points: { grid: { platform.cluster.clock: [200, 240] } }\n");
  ASSERT_EQ(run_program(folder_, {"sweep", path("before/plan.yaml"), "--out", path("before/swept"),
                                  "--quiet", "--cache", path("cache-moved")})
                .status,
            0);
  fs::rename(folder_ / "before", folder_ / "after");
  const std::vector<std::string> words{"compare", path("after/swept:1"), path("after/swept:2"),
                                       "--quiet"};
  const ProgramResult moved = run_program(folder_, words);
  EXPECT_EQ(moved.status, 0) << moved.err;
  ASSERT_EQ(
      run_program(folder_, {"run", "--platform", "gap9", "--data", path("flight"), "--record",
                            "--seed", "2", "--out", path("after/recorded"), "--quiet", "--force"})
          .status,
      0);
  testing::expect_refused(run_program(folder_, words), {"swept:1", "has changed", "--force"});
  fs::remove_all(folder_ / "after/recorded");
  testing::expect_refused(run_program(folder_, words), {"recorded"});
}

/// Hardware has a price, so the largest chip is not the only answer.
TEST_F(SweepCommand, FrontsOf72ChipsHaveSixPointsAndMore) {
  outputs::write_file_atomically(folder_ / "hardware.yaml",
                                 "base: { trace: recorded }\n"
                                 "points:\n"
                                 "  - grid:\n"
                                 "      platform.cluster.fpu.units: [1, 2, 4, 8]\n"
                                 "      platform.cluster.fpu.dividers: [1, 2, 8]\n"
                                 "      platform.cluster.icache.shared_size: [4KiB, 8KiB, 16KiB]\n"
                                 "      platform.cluster.l1.banks: [16, 32]\n");
  const ProgramResult swept =
      run_program(folder_, {"sweep", path("hardware.yaml"), "--quiet", "--out", path("hardware"),
                            "--cache", path("cache-hardware")});
  ASSERT_EQ(swept.status, 0) << swept.err;
  SweepStore store(folder_ / "hardware");
  ASSERT_EQ(store.outcomes().size(), 72u);
  const std::vector<SweepOutcome> front = pareto_front(store.outcomes());
  EXPECT_GE(front.size(), 6u);
  EXPECT_LT(front.size(), 72u) << "a front of all says nothing";
  EXPECT_EQ(std::count_if(front.begin(), front.end(),
                          [](const SweepOutcome& point) { return point.point == 1; }),
            1)
      << "the smallest has the least area";
}

TEST_F(SweepCommand, SlurmArraysMakeOneRun) {
  for (int task = 1; task <= 2; ++task)
    ASSERT_EQ(
        shell(fmt::format("SLURM_ARRAY_TASK_ID={} SLURM_ARRAY_TASK_COUNT=2 {} plan.yaml slurm",
                          task, example("slurm_array.sh"))),
        0)
        << base::read_text_file(folder_ / "shell.txt");
  ASSERT_EQ(shell(fmt::format("'{}' sweep --merge slurm/all slurm/shard-1 slurm/shard-2",
                              leviosim::tests::program_path())),
            0);
  EXPECT_EQ(csv("slurm/all"), csv("whole"));
}

/// Of a plan's two shares, one after the other, the first is killed once 20 points are done, and
/// its task queued again.
constexpr const char* kSlurmJob = R"sh(
set -eu
job=$(sbatch --parsable --array=1-2%1 --open-mode=append --output="$PWD/task-%a.txt" "$1" long.yaml queued)
until [ "$(find queued/cache -type f 2>/dev/null | wc -l)" -ge 20 ]; do sleep 0.02; done
scancel --signal=KILL --full "${job}_1"
until scontrol requeue "${job}_1" 2>/dev/null; do sleep 0.1; done
while [ -n "$(squeue --noheader --jobs="$job" 2>/dev/null)" ]; do
  scontrol update jobid="${job}_1" starttime=now 2>/dev/null || true # else two minutes later
  sleep 0.3
done
scontrol show job "$job" >jobs.txt
)sh";

TEST_F(SweepCommand, ATaskThatSlurmKillsAndQueuesAgainMakesTheSameRun) {
  outputs::write_file_atomically(folder_ / "long.yaml",
                                 "base: { trace: recorded }\n"
                                 "points:\n"
                                 "  - grid:\n"
                                 "      platform.cluster.clock: { from: 100, to: 364, step: 30 }\n"
                                 "      platform.cluster.fpu.units: [1, 2, 4, 8]\n"
                                 "      platform.cluster.dma.bytes_per_cycle: [1, 2, 4, 8]\n");
  outputs::write_file_atomically(folder_ / "job.sh", kSlurmJob);
  fs::create_directory(folder_ / "slurm-node");
  const int status =
      shell(fmt::format("timeout 600 '{}/tests/support/slurm.sh' slurm-node sh job.sh {}",
                        leviosim::tests::source_folder().string(), example("slurm_array.sh")));
  const std::string said = base::read_text_file(folder_ / "shell.txt");
  if (status == 77) GTEST_SKIP() << said;
  ASSERT_EQ(status, 0) << said;
  const std::string jobs = base::read_text_file(folder_ / "jobs.txt");
  EXPECT_NE(jobs.find("Restarts=1"), std::string::npos) << jobs;
  EXPECT_EQ(jobs.find("FAILED"), std::string::npos) << jobs;
  // Killed in the middle: of its 72 points, some were done before, the others are done now.
  const std::string task = base::read_text_file(folder_ / "task-1.txt");
  std::smatch counts;
  ASSERT_TRUE(std::regex_search(task, counts, std::regex("(\\d+) computed .* (\\d+) done before")))
      << task;
  EXPECT_GT(std::stoi(counts[1]), 0) << task;
  EXPECT_GT(std::stoi(counts[2]), 0) << task;

  const auto long_sweep = [](std::vector<std::string> words) {
    words.insert(words.begin(), "sweep");
    const ProgramResult result = run_program(folder_, std::move(words));
    EXPECT_EQ(result.status, 0) << result.err;
  };
  long_sweep({"--merge", path("queued/all"), path("queued/shard-1"), path("queued/shard-2")});
  long_sweep(
      {path("long.yaml"), "--out", path("undisturbed"), "--cache", path("cache-long"), "--quiet"});
  EXPECT_EQ(csv("queued/all"), csv("undisturbed"));
}

TEST_F(SweepCommand, SnakemakeMakesOneRun) {
  if (std::system("snakemake --version >/dev/null 2>&1") != 0)  // NOLINT: as above
    GTEST_SKIP() << "snakemake is not installed; apt-get install snakemake";
  ASSERT_EQ(shell(fmt::format("snakemake --snakefile {} --cores 2 --config plan=plan.yaml "
                              "out=snakemake shares=3",
                              example("Snakefile"))),
            0)
      << base::read_text_file(folder_ / "shell.txt");
  EXPECT_EQ(csv("snakemake/all"), csv("whole"));
}

/// Of a folder, of folders with shares, and of none; the rest is divided by the time that it takes.
TEST_F(SweepCommand, StatusSaysWhatIsDoneAndHowLongTheRestTakes) {
  const auto status = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"sweep", path("plan.yaml"), "--status", "--json"});
    const ProgramResult result = run_program(folder_, words);
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out);
  };
  const Json before = status({"--out", path("nowhere")});
  EXPECT_EQ(before["done"], 0);
  EXPECT_EQ(before["open"], before["points"]);
  EXPECT_GT(before["seconds_a_point"], 0);
  EXPECT_EQ(before["shares"], 1) << "a task of ten minutes holds them all";
  EXPECT_GT(status({"--task-minutes", "1e-6"})["shares"], 1);
  const Json whole = status({"--out", path("whole")});
  EXPECT_EQ(whole["done"], whole["points"]);
  EXPECT_TRUE(whole["seconds_a_point"].is_null());
  ASSERT_EQ(run_program(folder_, {"sweep", path("plan.yaml"), "--shard", "1/2", "--out",
                                  path("parts/one"), "--cache", path("cache-parts"), "--quiet"})
                .status,
            1)
      << "a point cannot run";
  const Json half = status({"--out", path("parts")});
  EXPECT_GT(half["done"], 0);
  EXPECT_EQ(half["done"].get<int>() + half["open"].get<int>(), half["points"].get<int>());
  EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
  expect_refused(run_program(folder_, {"sweep", path("plan.yaml"), "--task-minutes", "5"}),
                 {"--task-minutes", "--status"});
}

TEST_F(SweepCommand, GnuParallelMakesOneRun) {
  if (std::system("parallel --version 2>/dev/null | grep -q GNU") != 0)  // NOLINT: as above
    GTEST_SKIP() << "GNU parallel is not installed";
  ASSERT_EQ(shell(example("gnu_parallel.sh") + " plan.yaml parallel 3"), 0)
      << base::read_text_file(folder_ / "shell.txt");
  EXPECT_EQ(csv("parallel/all"), csv("whole"));
}

}  // namespace
}  // namespace leviosim::tools
