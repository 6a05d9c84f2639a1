#include "tools/app/run/known_runs.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "sim/base/check.h"
#include "sim/chip/same_cycles.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/run/simulate.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostRuns = 16;

Cycles sum_of(const sim::JobTiming& timing) {
  Cycles sum;
  for (const sim::StageTiming& stage : timing.stages) sum += stage.cycles;
  return sum;
}

/// What the jobs of a run take on their cores, by frame.
struct JobCycles {
  Cycles front_end;
  std::vector<Cycles> iterations{};  ///< of the optimisation that began with it
};

class CyclesRecorder : public RunObserver {
 public:
  void on_start(const RunSubject&, int frames) override {
    cycles.resize(static_cast<std::size_t>(frames));
  }
  void on_front_end(const FrontEndJob& e) override {
    cycles[static_cast<std::size_t>(e.frame)].front_end = sum_of(e.parallel);
  }
  void on_optimiser(const OptimiserJob& e) override {
    cycles[static_cast<std::size_t>(e.frame)].iterations.push_back(sum_of(e.timing));
  }

  std::vector<JobCycles> cycles;
};

}  // namespace

struct KnownRuns::Run {
  const traces::WorkTrace* trace;
  sim::ChipConfig chip;
  int cores;
  bool on_one_core;
  TimeBandsOf time_bands;
  std::vector<JobCycles> cycles;
  Replay replay;
};

namespace {

/// Frames of a run that is known. Their work is empty, for what it takes is known.
class KnownSource : public RunSource {
 public:
  KnownSource(const traces::WorkTrace& trace, const Replay& known,
              const std::vector<JobCycles>& cycles)
      : trace_(trace), known_(known), cycles_(cycles) {}

  int frames() const override { return trace_.frames(); }
  std::int64_t time_ns(int frame) const override {
    return trace_.info().stamps_ns[static_cast<std::size_t>(frame)];
  }
  bool begin_frame(const soc::FrameStart& start) override;
  const work::Job& process(FrameResult& result) override;
  int iterations() const override { return static_cast<int>(iterations_.size()); }
  const work::Job& optimise() override {
    takes_ = iterations_[next_iteration_++];
    return nothing_;
  }
  std::optional<Cycles> known_cycles() const override { return takes_; }
  void publish() override {}
  std::vector<StageResult> empty_stages() const override { return known_.run.stages; }
  RunSubject subject() const override { return subject_of(trace_); }
  void describe(RunResult& result) const override { describe_recording(trace_, result); }

  /// Whether the same frames and optimisations were run.
  bool is_same() const { return is_same_ && comparisons_.size() == known_.frames.size(); }
  const std::vector<FrameComparison>& comparisons() const { return comparisons_; }

 private:
  const traces::WorkTrace& trace_;
  const Replay& known_;
  const std::vector<JobCycles>& cycles_;
  bool is_same_ = true;
  Cycles takes_;  ///< the job that was handed out last
  std::vector<Cycles> iterations_;
  std::size_t next_iteration_ = 0;
  std::vector<FrameComparison> comparisons_;
  const work::Job nothing_;
};

bool KnownSource::begin_frame(const soc::FrameStart& start) {
  const std::size_t number = comparisons_.size();
  is_same_ =
      is_same_ && number < known_.frames.size() && known_.frames[number].frame == start.frame;
  if (!is_same_) return false;
  const FrameComparison& then = known_.frames[number];
  const std::int64_t arrival_ns = time_ns(start.frame) - time_ns(0);
  const bool begun = then.recorded.optimised && !start.optimiser_busy;
  comparisons_.push_back({start.frame,
                          then.recorded,
                          {start.start_ns - arrival_ns, start.optimiser_busy, begun, start.seen}});
  is_same_ = begun == then.replayed.optimised;
  if (!is_same_ || !begun) return false;
  iterations_ = cycles_[static_cast<std::size_t>(start.frame)].iterations;
  next_iteration_ = 0;
  return true;
}

const work::Job& KnownSource::process(FrameResult& result) {
  takes_ = {};
  if (!is_same_) return nothing_;
  result = known_.run.frames[comparisons_.size() - 1];
  takes_ = cycles_[static_cast<std::size_t>(comparisons_.back().frame)].front_end;
  return nothing_;
}

bool moves_external(const RunResult& run) {
  return std::any_of(run.stages.begin(), run.stages.end(), [](const StageResult& stage) {
    return stage.on_controller && stage.account.team[sim::Mechanism::Transfer] != 0;
  });
}

bool fits(const RunResult& run, const sim::ChipConfig& chip) {
  return std::all_of(run.stages.begin(), run.stages.end(), [&](const StageResult& stage) {
    return stage.memory.parallel <= (stage.on_controller ? chip.l2.size : chip.cluster.l1.size);
  });
}

/// Nothing if other frames or optimisations are run on the chip of the request.
std::optional<Replay> repeat(const traces::WorkTrace& trace, const Replay& known,
                             const std::vector<JobCycles>& cycles, RunRequest request,
                             const ProgressCallback& progress) {
  request.time_bands = TimeBandsOf::nothing;
  KnownSource source(trace, known, cycles);
  Replay result;
  result.run = simulate_source(request, source, progress);
  if (!source.is_same()) return std::nullopt;
  result.run.offload = known.run.offload;
  result.run.time_bands = known.run.time_bands;
  result.run.frame_stages = known.run.frame_stages;
  for (std::size_t i = 0; i < result.run.frames.size(); ++i) {
    result.run.frames[i].stage_cycles = known.run.frames[i].stage_cycles;
    result.run.frames[i].single_cycles = known.run.frames[i].single_cycles;
  }
  result.frames = source.comparisons();
  result.recorded_l1 = known.recorded_l1;
  return result;
}

}  // namespace

std::shared_ptr<const KnownRuns::Run> KnownRuns::find(const traces::WorkTrace& trace,
                                                      const RunRequest& request) const {
  const sim::ChipConfig& chip = request.platform.config;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const std::shared_ptr<const Run>& run : runs_)
    if (run->trace == &trace && run->cores == request.cores &&
        run->on_one_core == request.on_one_core && run->time_bands == request.time_bands &&
        sim::takes_same_cycles(run->chip, chip, moves_external(run->replay.run)) &&
        fits(run->replay.run, chip))
      return run;
  return nullptr;
}

void KnownRuns::keep(std::shared_ptr<const Run> run) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (runs_.size() == kMostRuns) runs_.erase(runs_.begin());
  runs_.push_back(std::move(run));
}

Replay KnownRuns::replay(const traces::WorkTrace& trace, const RunRequest& request,
                         const ProgressCallback& progress) {
  check(request.observer == nullptr, "who looks on has to see the jobs");
  check_cores(trace, request);
  if (const std::shared_ptr<const Run> known = find(trace, request))
    if (std::optional<Replay> again =
            repeat(trace, known->replay, known->cycles, request, progress)) {
      const std::lock_guard<std::mutex> lock(mutex_);
      ++repeated_;
      return *std::move(again);
    }
  CyclesRecorder recorder;
  RunRequest observed = request;
  observed.observer = &recorder;
  const auto run = std::make_shared<Run>(Run{&trace,
                                             request.platform.config,
                                             request.cores,
                                             request.on_one_core,
                                             request.time_bands,
                                             {},
                                             tools::replay(trace, observed, progress)});
  run->cycles = std::move(recorder.cycles);
  keep(run);
  return run->replay;
}

std::size_t KnownRuns::repeated() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return repeated_;
}

}  // namespace leviosim::tools
