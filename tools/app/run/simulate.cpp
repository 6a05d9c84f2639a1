#include "tools/app/run/simulate.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "sim/base/error.h"
#include "sim/soc/simulation.h"
#include "sim/work/arena.h"
#include "tools/app/run/least_memory.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/run/run_source.h"
#include "tools/app/run/time_bands.h"
#include "tools/app/run/workload.h"
#include "traces/datasets/image_file.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

/// @param names  of stages; gets those that are new
std::vector<Cycles> stage_cycles(const sim::JobTiming& timing, std::vector<std::string>& names) {
  std::vector<Cycles> cycles;
  cycles.reserve(names.size());
  for (const sim::StageTiming& run : timing.stages) {
    const auto name = std::find(names.begin(), names.end(), run.stage);
    const auto number = static_cast<std::size_t>(name - names.begin());
    if (name == names.end()) names.emplace_back(run.stage);
    if (number >= cycles.size()) cycles.resize(number + 1);
    cycles[number] += run.cycles;
  }
  return cycles;
}

/// The last frame may tell where others were after all, which locates them if its map is aligned.
/// Then nothing of that is kept.
void correct_earlier(std::vector<FrameResult>& frames) {
  for (const auto& [ago, pose] : frames.back().earlier) {
    FrameResult& frame = frames[frames.size() - 1 - static_cast<std::size_t>(ago)];
    frame.pose = pose;
    frame.state = vio::state_after(frame.state, frames.back().state);
  }
  frames.back().earlier = {};
}

/// Joins what the frames yielded with when they were processed.
class FrameCollector : public soc::Observer {
 public:
  /// @param sample  of jobs, to be filled; may be null
  FrameCollector(const RunSource& source, RunObserver* observer, JobSample* sample)
      : source_(source), observer_(observer), sample_(sample) {
    frames.reserve(static_cast<std::size_t>(source.frames()));
  }

  bool wants_steps() const override { return observer_ != nullptr && observer_->wants_steps(); }

  void on_front_end(const soc::FrontEndJob& e) override {
    FrameResult& frame = frames.emplace_back(source_.frame());
    correct_earlier(frames);
    static_cast<soc::FrameTiming&>(frame) = e.times;
    frame.stage_cycles = stage_cycles(e.parallel, stages);
    if (sample_ != nullptr) sample_->add_frame(e.job, e.times.cycles);
    if (observer_ != nullptr)
      observer_->on_front_end({e.frame, e.optimisation_begun, frame, e.job, e.parallel, e.single});
  }
  void on_optimiser(const OptimiserJob& e) override {
    if (sample_ != nullptr) sample_->add_iteration(e.job, e.timing);
    if (observer_ != nullptr) observer_->on_optimiser(e);
  }

  std::vector<FrameResult> frames;
  std::vector<std::string> stages;  ///< RunResult::frame_stages

 private:
  const RunSource& source_;
  RunObserver* observer_;
  JobSample* sample_;
};

/// Fills in what does not depend on timing.
void describe(RunResult& result, const RunRequest& request, const RunSource& source) {
  const sim::ChipConfig& chip = request.platform.config;
  result.timed = !request.native;
  result.cores = request.cores;
  result.cluster_clock = chip.cluster.clock;
  result.controller_clock = chip.controller.clock;
  if (result.timed) result.chip = chip;
  result.l1_size = chip.cluster.l1.size;
  result.l2_size = chip.l2.size;
  result.external_size = chip.controller.external.size;
  for (const FrameResult& frame : result.frames) {
    if (frame.pose.T_world_body.matrix().allFinite())
      result.trajectory.push_back(frame.pose);
    else
      ++result.poses_left_out;
  }
  static_cast<RunSubject&>(result) = source.subject();
  source.describe(result);
}

/// What persists in L2 lies below whatever the controller allocates; it has rows of its own.
void add_l2_rows(RunResult& result) {
  Bytes persistent;
  for (const L2Row& row : result.l2) persistent += row.bytes;
  L2Row optimiser{kOptimiserL2, Bytes(0), {}};
  for (const StageResult& stage : result.stages) {
    if (!stage.on_controller || stage.memory.parallel <= optimiser.bytes + persistent) continue;
    optimiser = {kOptimiserL2, stage.memory.parallel - persistent, stage.memory.blocks};
    std::erase_if(optimiser.blocks,
                  [](const work::Block& block) { return block.name == vio::kPersistentBlock; });
  }
  if (optimiser.bytes > Bytes(0)) result.l2.push_back(optimiser);
  if (result.camera) {
    const Bytes size = soc::second_buffer(result.image_width, result.image_height);
    result.l2.push_back({kCameraL2, size, {{"second image buffer", Bytes(0), size}}});
  }
}

/// The golden model: the same computation without a chip. The optimiser's result of a frame is
/// published before the next one, as on a chip that keeps up.
RunResult run_natively(const RunRequest& request, const ProgressCallback& progress) {
  const std::unique_ptr<RunSource> made = make_source(request);
  RunSource& source = *made;
  RunResult result;
  for (int i = 0; i < source.frames(); ++i) {
    const bool optimising = source.begin_frame({.frame = i});
    FrameResult frame;
    source.process(frame);
    for (int k = 0; optimising && k < source.iterations(); ++k) source.optimise();
    if (optimising) {
      source.publish();
      ++result.optimiser_published;
    }
    result.frames.push_back(frame);
    correct_earlier(result.frames);
    progress({i + 1, source.frames(), source.time_ns(i) - source.time_ns(0)});
  }
  describe(result, request, source);
  return result;
}

/// What of images larger than by default fills the memories, and how to have less of it; empty for
/// other images.
std::string advice_on_size(const RunRequest& request) {
  if (vio::other_profile(request.profile) != nullptr) return {};
  const auto extractor = profile_of(request).extractor;
  const auto features = [&](const traces::ImageSize& size) {
    return extractor.max_features(size.width, size.height);
  };
  const traces::ImageSize size = request.image_size;
  if (features(size) <= features(RunRequest().image_size)) return {};
  return fmt::format(
      "; an image of {}x{} has up to {} features, {} of each cell of {} px: expected larger cells "
      "(-p workload.cell=N), fewer features of each (-p workload.features_per_cell=N), or a "
      "smaller image",
      size.width, size.height, features(size), extractor.per_cell, extractor.cell);
}

RunResult run_on_chip(const RunRequest& request, const ProgressCallback& progress) {
  try {
    const std::unique_ptr<RunSource> live = make_source(request);
    if (request.recording == nullptr) return simulate_source(request, *live, progress);
    RecordingSource recorded(*live, *request.recording);
    RunResult result = simulate_source(request, recorded, progress);
    recorded.finish();
    return result;
  } catch (const work::MemoryOverflow& overflow) {
    throw work::MemoryOverflow(
        fmt::format("{}: {}; {}{} (leviosim platforms feasibility says what each chip lacks)",
                    request.platform.name, overflow.what(), larger_memory(request, overflow),
                    advice_on_size(request)),
        overflow.memory());
  }
}

}  // namespace

RunResult simulate_source(const RunRequest& request, RunSource& source,
                          const ProgressCallback& progress) {
  soc::Setup setup{request.platform.config, request.cores, {}, request.on_one_core};
  if (request.camera) setup.deadline = request.camera->deadline;
  if (request.observer != nullptr) request.observer->on_start(source.subject(), source.frames());
  JobSample sample;
  FrameCollector collector(source, request.observer,
                           request.time_bands == TimeBandsOf::nothing ? nullptr : &sample);
  soc::Outcome outcome = soc::Simulation(setup, source, collector, progress).run();
  RunResult result;
  result.stages = std::move(outcome.stages);
  result.offload = outcome.offload;
  result.frames = std::move(collector.frames);
  result.frame_stages = std::move(collector.stages);
  result.camera = std::move(outcome.camera);
  result.optimiser_published = outcome.optimiser_published;
  result.optimiser_late = outcome.optimiser_late;
  describe(result, request, source);
  add_l2_rows(result);
  if (!sample.empty())
    result.time_bands = time_bands(request.platform, request.cores, sample, request.time_bands);
  return result;
}

RunResult simulate(const RunRequest& request, const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  RunResult result =
      request.native ? run_natively(request, progress) : run_on_chip(request, progress);
  result.host_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace leviosim::tools
