#include "tools/app/validation/frame_log.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/work/op.h"
#include "tools/app/result/summary.h"
#include "tools/app/validation/paper_stages.h"
#include "tools/app/validation/paths.h"
#include "tools/app/validation/ransac_samples.h"

namespace leviosim::tools {
namespace {

LoggedStage& stage_of(LoggedFrame& frame, std::string_view name) {
  const auto it = std::find_if(frame.stages.begin(), frame.stages.end(),
                               [&](const LoggedStage& stage) { return stage.name == name; });
  if (it != frame.stages.end()) return *it;
  LoggedStage stage;
  stage.name = name;
  frame.stages.push_back(stage);
  return frame.stages.back();
}

using work::Op;

constexpr std::string_view kEpnp = "solve EPnP";
constexpr std::string_view kEightPoint = "8-point hypotheses";

double number(const work::Counts& counts, Op op) { return static_cast<double>(counts[op]); }
double rotations(const work::Counts& hypothesis) { return number(hypothesis, Op::F64Mul) / 2; }

/// In whole steps, at least the one that finds no pivot.
double steps(const work::Counts& hypothesis) {
  constexpr double kOutsideOfSteps = 21;
  constexpr double kOfAStep = 54;
  const double divisions = number(hypothesis, Op::F32Div) - rotations(hypothesis) - kOutsideOfSteps;
  return std::max(1.0, std::round(divisions / kOfAStep));
}

using Value = std::optional<double>;
using Frames = std::vector<LoggedFrame>;

bool ran(const LoggedFrame& frame, std::string_view stage) { return frame.find(stage) != nullptr; }

template <class Wanted>
Frames frames_that(const FrameLog& log, const Wanted& wanted) {
  Frames frames;
  for (const LoggedFrame& frame : log.frames())
    if (frame.result.source != PoseSource::First && wanted(frame)) frames.push_back(frame);
  return frames;
}

/// A path's frames, and what share of all frames they are in the paper.
struct Path {
  Frames frames;
  double share;

  /// Of the paper's frames, those that take the path and come to the stage.
  double weight(const StageSum& sum) const {
    if (frames.empty()) return 0;
    return share * static_cast<double>(sum.frames) / static_cast<double>(frames.size());
  }
};

Value weighed(Value a, double weight_a, Value b, double weight_b) {
  if (!a || !b) return std::nullopt;
  return (*a * weight_a + *b * weight_b) / (weight_a + weight_b);
}

}  // namespace

const LoggedStage* LoggedFrame::find(std::string_view name) const {
  const auto it = std::find_if(stages.begin(), stages.end(),
                               [&](const LoggedStage& stage) { return stage.name == name; });
  return it == stages.end() ? nullptr : &*it;
}

void FrameLog::on_front_end(const FrontEndJob& event) {
  LoggedFrame frame;
  frame.result = event.result;
  frame.landmarks_before = frames_.empty() ? 0 : frames_.back().result.landmarks;
  frame.keyframe_features = keyframe_features_;
  const std::size_t runs = event.job.stages.size();
  check_equal(event.parallel.stages.size(), runs, "timed stages of a job");
  check_equal(event.single.stages.size(), runs, "stages of a job timed on one core");
  for (std::size_t i = 0; i < runs; ++i) {
    LoggedStage& stage = stage_of(frame, event.job.stages[i].stage);
    ++stage.calls;
    stage.parallel += event.parallel.stages[i].cycles;
    stage.single += event.single.stages[i].cycles;
    for (const work::Step& step : event.job.stages[i].steps) {
      if (const auto* serial = std::get_if<work::Serial>(&step))
        stage.work.add(serial->counts, code_);
      if (const auto* fork = std::get_if<work::Fork>(&step))
        stage.work.add(work::shares_on_one_core(*fork), code_);
    }
  }
  ransac_.add(event.job);
  if (event.result.keyframe) keyframe_features_ = event.result.features;
  frames_.push_back(std::move(frame));
}

void FrameLog::on_optimiser(const OptimiserJob& event) {
  Cycles cycles;
  bool iterated = false;
  for (const sim::StageTiming& stage : event.timing.stages) {
    if (stage.stage != vio::stages::kOptimiser) continue;
    cycles += stage.cycles;
    iterated = true;
  }
  if (iterated) iterations_.push_back({event.frame, cycles});
}

void RansacSamples::add(const work::Job& job) {
  for (const work::StageRun& stage : job.stages)
    for (const work::Step& step : stage.steps) {
      const auto* fork = std::get_if<work::Fork>(&step);
      if (fork == nullptr || (fork->name != kEpnp && fork->name != kEightPoint)) continue;
      double most = 0;
      for (const work::Segment& hypothesis : fork->shares) {
        if (hypothesis.empty()) continue;
        if (fork->name == kEpnp) {
          epnp_rotations.push_back(rotations(hypothesis));
          continue;
        }
        eight_point_rotations.push_back(rotations(hypothesis));
        eight_point_steps.push_back(steps(hypothesis));
        most = std::max(most, eight_point_steps.back());
      }
      if (fork->name == kEightPoint) slowest_of_eight.push_back(most);
    }
}

std::vector<StageOnPaths> stages_on_paths(const FrameLog& log) {
  const auto on_eight_point = [](const LoggedFrame& f) { return ran(f, vio::stages::kEightPoint); };
  const auto on_epnp = [&](const LoggedFrame& f) {
    return ran(f, vio::stages::kEpnp) && !on_eight_point(f);
  };
  const Path epnp{frames_that(log, on_epnp), kPaperEpnpFrames};
  const Path eight_point{frames_that(log, on_eight_point), kPaperEightPointFrames};
  std::vector<StageOnPaths> stages;
  for (const PaperStage& stage : kPaperStages) {
    if (stage.stage == vio::stages::kEpnp || stage.stage == vio::stages::kEightPoint) continue;
    const StageSum a = sum_over(epnp.frames, stage), b = sum_over(eight_point.frames, stage);
    const auto means = [&](Value (StageSum::*mean)() const) {
      const Value of_a = (a.*mean)(), of_b = (b.*mean)();
      return StageOnPaths::Means{of_a, of_b,
                                 weighed(of_a, epnp.weight(a), of_b, eight_point.weight(b))};
    };
    stages.push_back(
        {stage.key, stage.title, means(&StageSum::mean_single), means(&StageSum::mean_parallel)});
  }
  return stages;
}

}  // namespace leviosim::tools
