#include "tools/app/validation/paper_stages.h"

#include "tools/app/result/summary.h"
#include "tools/app/validation/frame_log.h"

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

}  // namespace leviosim::tools
