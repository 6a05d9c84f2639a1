#include "tools/app/validation/paper_stages.h"

#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

std::int64_t pairs_of(const LoggedFrame& frame, std::string_view stage) {
  const std::int64_t features = frame.result.features;
  if (stage == vio::stages::kFrameMatching) return features * frame.keyframe_features;
  if (stage == vio::stages::kWorldMatching) return features * frame.landmarks_before;
  return 0;
}

}  // namespace

std::optional<double> StageSum::mean_single() const { return mean(single, frames); }
std::optional<double> StageSum::mean_parallel() const { return mean(parallel, frames); }

StageSum sum_over(const std::vector<LoggedFrame>& frames, const PaperStage& stage) {
  StageSum sum;
  for (const LoggedFrame& frame : frames) {
    const LoggedStage* logged = frame.find(stage.stage);
    if (logged == nullptr || !stage.stands_for(frame)) continue;
    ++sum.frames;
    sum.single += logged->single;
    sum.parallel += logged->parallel;
    sum.work += logged->work;
    sum.pairs += pairs_of(frame, stage.stage);
    sum.features += frame.result.features;
    sum.landmarks += frame.landmarks_before;
    sum.matches += frame.result.frame_matches;
  }
  return sum;
}

namespace {

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
