#include "tools/app/validation/run_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "tools/app/validation/paper_stages.h"
#include "tools/app/validation/paths.h"
#include "tools/app/validation/quantities.h"
#include "tools/app/validation/references.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using Value = std::optional<double>;

constexpr std::string_view kPrinted = "printed in the paper";

constexpr std::string_view kRelease = "parameter of its release";

constexpr std::string_view kNotPrinted = "not printed";

Value mean_over(const FrameLog& log, const std::function<bool(const LoggedFrame&)>& counts,
                const std::function<double(const LoggedFrame&)>& value) {
  double sum = 0;
  std::int64_t n = 0;
  for (const LoggedFrame& frame : log.frames()) {
    if (!counts(frame)) continue;
    sum += value(frame);
    ++n;
  }
  return n > 0 ? Value(sum / static_cast<double>(n)) : std::nullopt;
}

const PaperStage& paper_stage(std::string_view key) {
  return *std::find_if(kPaperStages.begin(), kPaperStages.end(),
                       [&](const PaperStage& stage) { return stage.key == key; });
}

/// Landmarks in the map, over the frames that the average of world matching stands for.
Value mean_of_map(const FrameLog& log) {
  const StageSum sum = sum_over(log.frames(), paper_stage("world_matching"));
  if (sum.frames == 0) return std::nullopt;
  return static_cast<double>(sum.landmarks) / static_cast<double>(sum.frames);
}

bool every(const LoggedFrame&) { return true; }

bool after_first(const LoggedFrame& frame) { return frame.result.source != PoseSource::First; }

Value percent_of_frames(const FrameLog& log,
                        const std::function<bool(const LoggedFrame&)>& counts) {
  return mean_over(log, after_first,
                   [&](const LoggedFrame& frame) { return counts(frame) ? 100.0 : 0.0; });
}

int samples_of(const LoggedFrame& frame) {
  const LoggedStage* imu = frame.find(vio::stages::kImu);
  return imu == nullptr ? 0 : imu->calls;
}

double pixels_of(const RunResult& run) {
  return static_cast<double>(run.image_width) * run.image_height;
}

/// The paper's one-core cycles of a stage.
Value paper_single(std::string_view key) {
  for (const Reference& reference : paper_references())
    if (reference.name == fmt::format("compute.{}.single", key)) return reference.value * 1e3;
  return std::nullopt;
}

/// What a stage's cycles are divided by: units of all the frames that its average stands for.
struct Unit {
  std::string_view stage;  ///< key
  std::string_view name;
  double (*units)(const RunResult&, const vio::Profile&, const StageSum&);
  Value paper;
};

constexpr double kPaperPixels = 160 * 120;

const std::array kUnits{
    Unit{"feature_extraction", "pixel",
         [](const RunResult& run, const vio::Profile&, const StageSum& s) {
           return pixels_of(run) * static_cast<double>(s.frames);
         },
         kPaperPixels},
    Unit{"feature_extraction",
         "feature",
         [](const RunResult&, const vio::Profile&, const StageSum& s) {
           return static_cast<double>(s.features);
         },
         {}},
    Unit{"frame_matching",
         "pair of descriptors",
         [](const RunResult&, const vio::Profile&, const StageSum& s) {
           return static_cast<double>(s.pairs);
         },
         {}},
    Unit{"world_matching",
         "pair of descriptors",
         [](const RunResult&, const vio::Profile&, const StageSum& s) {
           return static_cast<double>(s.pairs);
         },
         {}},
    Unit{"epnp_ransac", "RANSAC iteration",
         [](const RunResult&, const vio::Profile& p, const StageSum& s) {
           return static_cast<double>(s.frames * p.epnp.iterations);
         },
         64.0},
    Unit{"eight_point_ransac", "RANSAC iteration",
         [](const RunResult&, const vio::Profile& p, const StageSum& s) {
           return static_cast<double>(s.frames * p.essential.iterations);
         },
         640.0},
    Unit{"triangulation",
         "match with the keyframe",
         [](const RunResult&, const vio::Profile&, const StageSum& s) {
           return static_cast<double>(s.matches);
         },
         {}},
};

NormalisedFigure figure_of(const RunResult& run, const FrameLog& log, const vio::Profile& profile,
                           const Unit& unit) {
  const PaperStage& stage = paper_stage(unit.stage);
  const StageSum sum = sum_over(log.frames(), stage);
  NormalisedFigure figure;
  figure.stage = stage.title;
  figure.unit = unit.name;
  figure.paper_units = unit.paper;
  figure.paper_single = paper_single(unit.stage);
  const double units = unit.units(run, profile, sum);
  if (sum.frames == 0 || !(units > 0)) return figure;
  figure.units = units / static_cast<double>(sum.frames);
  figure.single = static_cast<double>(sum.single.count()) / units;
  figure.parallel = static_cast<double>(sum.parallel.count()) / units;
  if (!unit.paper && figure.paper_single)
    figure.explaining_units = *figure.paper_single / *figure.single;
  return figure;
}

NormalisedFigure optimiser_figure(const FrameLog& log) {
  NormalisedFigure figure;
  figure.stage = "optimiser iteration";
  figure.unit = "landmark of the map";
  double cycles = 0;
  double landmarks = 0;
  for (const LoggedIteration& iteration : log.iterations()) {
    cycles += static_cast<double>(iteration.cycles.count());
    landmarks += log.frames().at(static_cast<std::size_t>(iteration.frame)).landmarks_before;
  }
  if (!(landmarks > 0)) return figure;
  figure.units = landmarks / static_cast<double>(log.iterations().size());
  figure.single = figure.parallel = cycles / landmarks;
  return figure;
}

}  // namespace

std::vector<InputFigure> inputs_of(const RunResult& run, const FrameLog& log,
                                   const vio::Profile& profile) {
  const auto has_keyframe = [](const LoggedFrame& f) { return f.keyframe_features > 0; };
  const auto ran_epnp = [](const LoggedFrame& f) { return f.find(vio::stages::kEpnp) != nullptr; };
  const auto from = [](PoseSource source) {
    return [source](const LoggedFrame& f) { return f.result.source == source; };
  };
  const auto is_keyframe = [](const LoggedFrame& f) { return f.result.keyframe; };
  return {
      {"frames", "frames", "1", static_cast<double>(log.frames().size()), 1578, kPrinted},
      {"pixels of an image", "pixels", "1", pixels_of(run), kPaperPixels, kPrinted},
      {"features of a frame",
       "features",
       "1",
       mean_over(log, every, [](const LoggedFrame& f) { return f.result.features; }),
       {},
       kNotPrinted},
      {"features of the keyframe compared with",
       "keyframe_features",
       "1",
       mean_over(log, has_keyframe, [](const LoggedFrame& f) { return f.keyframe_features; }),
       {},
       kNotPrinted},
      {"landmarks compared with",
       "landmarks",
       "1",
       mean_of_map(log),
       {},
       "not printed; at most 1000"},
      {"world matches of a frame that ran EPnP",
       "world_matches",
       "1",
       mean_over(log, ran_epnp, [](const LoggedFrame& f) { return f.result.world_matches; }),
       {},
       kNotPrinted},
      {"frame matches of a frame with an 8-point pose",
       "frame_matches",
       "1",
       mean_over(log, from(PoseSource::EightPoint),
                 [](const LoggedFrame& f) { return f.result.frame_matches; }),
       {},
       kNotPrinted},
      {"RANSAC iterations, EPnP", "epnp_iterations", "1",
       static_cast<double>(profile.epnp.iterations), 64, kRelease},
      {"RANSAC iterations, 8-point", "eight_point_iterations", "1",
       static_cast<double>(profile.essential.iterations), 640, kRelease},
      {"IMU samples of a frame", "imu_samples", "1",
       mean_over(log, after_first, [](const LoggedFrame& f) { return samples_of(f); }), 10,
       kPrinted},
      {"frames with a pose from EPnP", "epnp_frames", "%",
       percent_of_frames(log, from(PoseSource::Epnp)), kPaperEpnpFrames, kPrinted},
      {"frames with a pose from 8-point", "eight_point_frames", "%",
       percent_of_frames(log, from(PoseSource::EightPoint)), kPaperEightPointFrames, kPrinted},
      {"frames that ran both", "frames_with_both", "%", percent_of_frames(log, ran_both), 0,
       "either is calculated"},
      {"keyframes", "keyframes", "%", percent_of_frames(log, is_keyframe), {}, kNotPrinted},
  };
}

std::vector<NormalisedFigure> normalised(const RunResult& run, const FrameLog& log,
                                         const vio::Profile& profile) {
  std::vector<NormalisedFigure> figures;
  for (const Unit& unit : kUnits) figures.push_back(figure_of(run, log, profile, unit));
  figures.push_back(optimiser_figure(log));
  return figures;
}

}  // namespace leviosim::tools
