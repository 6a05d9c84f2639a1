// What an observer sees of a run is the run: its sums, its times, and what re-timing gives.

#include <gtest/gtest.h>

#include <map>

#include "platform_models/loader/variants.h"
#include "sim/soc/job_timer.h"
#include "tests/traces/test_folder.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/run/simulate.h"
#include "tools/app/validation/calibration/calibration.h"
#include "tools/app/validation/paper_stages.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

/// Keeps everything that it is shown.
class Notes : public RunObserver {
 public:
  struct Frame {
    int frame;
    bool begun;
    FrameResult result;
    work::Job job;
    sim::JobTiming parallel;
    sim::JobTiming single;
  };
  struct Iteration {
    int frame;
    int iteration;
    bool last;
    work::Job job;
    sim::JobTiming timing;
  };
  void on_front_end(const FrontEndJob& e) override {
    frames.push_back({e.frame, e.optimisation_begun, e.result, e.job, e.parallel, e.single});
  }
  void on_optimiser(const OptimiserJob& e) override {
    iterations.push_back({e.frame, e.iteration, e.last, e.job, e.timing});
  }
  std::vector<Frame> frames;
  std::vector<Iteration> iterations;
};

/// Three seconds of synthetic flight, made once for all tests of this program.
const std::filesystem::path& flight() {
  static const std::filesystem::path folder = [] {
    const auto path = std::filesystem::temp_directory_path() /
                      fmt::format("leviosim-{}-observer-flight", ::getpid());
    traces::write_synthetic_flight(path, {.duration_s = 3, .texel_m = 0.01});
    return path;
  }();
  return folder;
}

class Observed : public ::testing::Test {
 protected:
  static void TearDownTestSuite() { std::filesystem::remove_all(flight()); }

  RunResult run(RunObserver* observer, const std::vector<std::string>& overrides = {}) {
    RunRequest request;
    request.data = flight();
    request.platform = platform::resolve_platform("gap9", overrides);
    request.observer = observer;
    return simulate(request, [](const Progress&) {});
  }
};

TEST_F(Observed, SeesEveryFrameAndEveryIteration) {
  Notes notes;
  const RunResult result = run(&notes);
  ASSERT_EQ(notes.frames.size(), result.frames.size());
  int begun = 0;
  for (std::size_t i = 0; i < notes.frames.size(); ++i) {
    EXPECT_EQ(notes.frames[i].frame, static_cast<int>(i));
    EXPECT_EQ(notes.frames[i].result.end_ns, result.frames[i].end_ns);
    begun += notes.frames[i].begun;
  }
  EXPECT_GT(begun, 0);
  // The run may end before the last optimisation does.
  EXPECT_LE(notes.iterations.size(), 3u * static_cast<std::size_t>(begun));
  EXPECT_GT(notes.iterations.size(), 3u * static_cast<std::size_t>(begun - 1));
  for (std::size_t k = 0; k < notes.iterations.size(); ++k) {
    EXPECT_EQ(notes.iterations[k].iteration, static_cast<int>(k % 3));
    EXPECT_EQ(notes.iterations[k].last, k % 3 == 2);
    EXPECT_TRUE(notes.frames[static_cast<std::size_t>(notes.iterations[k].frame)].begun);
  }
}

TEST_F(Observed, ChangesNothing) {
  Notes notes;
  const RunResult with = run(&notes);
  const RunResult without = run(nullptr);
  EXPECT_EQ(traces::format_tum(with.trajectory), traces::format_tum(without.trajectory));
  for (std::size_t i = 0; i < with.stages.size(); ++i)
    EXPECT_EQ(with.stages[i].parallel, without.stages[i].parallel) << with.stages[i].name;
}

TEST_F(Observed, StagesAddUpToTheRun) {
  Notes notes;
  const RunResult result = run(&notes);
  std::map<std::string_view, Cycles> parallel;
  std::map<std::string_view, Cycles> single;
  for (const Notes::Frame& frame : notes.frames) {
    for (const sim::StageTiming& s : frame.parallel.stages) parallel[s.stage] += s.cycles;
    for (const sim::StageTiming& s : frame.single.stages) single[s.stage] += s.cycles;
  }
  for (const StageResult& s : result.stages) {
    if (s.on_controller) continue;
    EXPECT_EQ(parallel[s.name], s.parallel) << s.name;
    EXPECT_EQ(single[s.name], s.single) << s.name;
  }
}

TEST_F(Observed, TimingRecordedJobsAgainGivesTheSameCycles) {
  Notes notes;
  run(&notes);
  soc::JobTimer timer(platform::load_platform("gap9"), 8);
  for (const Notes::Frame& frame : notes.frames) {
    const sim::JobTiming again = timer.front_end(frame.job);
    EXPECT_EQ(timer.front_end_cycles(again), frame.result.cycles) << frame.frame;
    ASSERT_EQ(again.stages.size(), frame.parallel.stages.size());
    for (std::size_t i = 0; i < again.stages.size(); ++i)
      EXPECT_EQ(again.stages[i].cycles, frame.parallel.stages[i].cycles);
  }
  for (const Notes::Iteration& iteration : notes.iterations)
    EXPECT_EQ(timer.optimiser(iteration.job).stages.back().cycles,
              iteration.timing.stages.back().cycles);
}

/// Logs what a run did as if its jobs had been on another chip. (A run on that chip would take
/// another flight: the optimiser finishes at other times.)
class LogOnAnotherChip : public RunObserver {
 public:
  explicit LogOnAnotherChip(const sim::ChipConfig& chip)
      : log(chip.cluster.core.code), timer_(chip, sim::Cluster::kMasterAlone) {}

  void on_front_end(const FrontEndJob& e) override {
    const sim::JobTiming single = timer_.front_end(e.job);
    log.on_front_end({e.frame, e.optimisation_begun, e.result, e.job, e.parallel, single});
  }

  FrameLog log;

 private:
  soc::JobTimer timer_;
};

/// A factor on what one run issued is what its jobs take on a chip whose instructions cost as much
/// more.
TEST_F(Observed, AFactorOnInstructionsIsTheRunOnAnotherChip) {
  constexpr double kFactor = 1.4;
  const sim::ChipConfig base = platform::load_platform("gap9");
  sim::ChipConfig changed = base;
  for (sim::OpCost& cost : changed.cluster.core.ops)
    if (!cost.routine) cost.issue *= kFactor;
  FrameLog log(base.cluster.core.code);
  run(&log);
  LogOnAnotherChip observer(changed);
  run(&observer);
  const std::vector<StageOnOneCore> stages = stages_on_one_core(log, base);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const StageSum after = sum_over(observer.log.frames(), kPaperStages[i]);
    EXPECT_NEAR(stages[i].with(kFactor) / after.mean_single().value(), 1, 1e-3) << stages[i].title;
    EXPECT_LT(stages[i].instructions, stages[i].cycles) << stages[i].title;
  }
}

}  // namespace
}  // namespace leviosim::tools
