#include "tools/app/validation/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "tools/app/result/summary.h"
#include "tools/app/table/terminal_table.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using Value = std::optional<double>;

Value ratio(Value a, Value b) {
  if (!a || !b || *b == 0) return std::nullopt;
  return *a / *b;
}

/// Mean of what is given, over the elements that have it.
class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++n_;
  }
  Value value() const { return n_ > 0 ? Value(sum_ / static_cast<double>(n_)) : std::nullopt; }

 private:
  double sum_ = 0;
  std::int64_t n_ = 0;
};

double kilo(Bytes bytes) { return static_cast<double>(bytes.count()) / 1000.0; }

class Quantities {
 public:
  Quantities(const RunResult& run, const FrameLog& log) : run_(run), log_(log) {
    for (const PaperStage& stage : kPaperStages)
      sums_.emplace(stage.key, sum_over(log.frames(), stage));
  }

  std::vector<Quantity> all() {
    add_stages();
    add_imu();
    add_optimiser();
    add_shares();
    add_latencies();
    add_l1();
    add_l2();
    return std::move(list_);
  }

 private:
  void add(std::string name, std::string_view unit, Value value) {
    list_.push_back({std::move(name), std::string(unit), value});
  }
  const StageSum& sum(std::string_view key) const { return sums_.find(key)->second; }
  double ms(Cycles cycles) const {
    return milliseconds(static_cast<double>(cycles.count()), run_.cluster_clock);
  }

  void add_stages() {
    for (const PaperStage& stage : kPaperStages) {
      const StageSum& s = sum(stage.key);
      const std::string path = fmt::format("compute.{}.", stage.key);
      add(path + "single", "kcycles", scaled(s.mean_single(), 1e-3));
      add(path + "multi", "kcycles", scaled(s.mean_parallel(), 1e-3));
      add(path + "speedup", "x", ratio(s.mean_single(), s.mean_parallel()));
    }
  }

  void add_imu() {
    Cycles single;
    Cycles parallel;
    Cycles front_end;
    std::int64_t samples = 0;
    for (const LoggedFrame& frame : log_.frames()) {
      const LoggedStage* stage = frame.find(vio::stages::kImu);
      // Until the first frame is through, samples are only averaged for gravity.
      if (stage == nullptr || frame.result.source == PoseSource::First) continue;
      single += stage->single;
      parallel += stage->parallel;
      samples += stage->calls;
      front_end += frame.result.cycles;
    }
    add("compute.imu_preintegration.per_sample", "kcycles", scaled(mean(single, samples), 1e-3));
    const Value share = ratio(mean(parallel, 1), mean(front_end, 1));
    add("compute.imu_preintegration.share", "%", scaled(share, 100));
  }

  void add_optimiser() {
    Cycles longest;
    std::map<int, Cycles> by_snapshot;
    for (const LoggedIteration& iteration : log_.iterations()) {
      longest = std::max(longest, iteration.cycles);
      by_snapshot[iteration.frame] += iteration.cycles;
    }
    Cycles longest_sum;
    for (const auto& [frame, cycles] : by_snapshot) longest_sum = std::max(longest_sum, cycles);
    const auto ms_of = [&](Cycles cycles) -> Value {
      if (by_snapshot.empty()) return std::nullopt;
      return milliseconds(static_cast<double>(cycles.count()), run_.controller_clock);
    };
    add("compute.optimiser.longest_iteration", "ms", ms_of(longest));
    add("compute.optimiser.longest_frame", "ms", ms_of(longest_sum));
  }

  void add_shares() {
    for (const auto& [name, ransac] :
         {std::pair("epnp", "epnp_ransac"), std::pair("eight_point", "eight_point_ransac")}) {
      Value frame = 0.0;
      for (const std::string_view key :
           {std::string_view("feature_extraction"), std::string_view("frame_matching"),
            std::string_view("world_matching"), std::string_view(ransac)}) {
        const Value part = sum(key).mean_parallel();
        frame = frame && part ? Value(*frame + *part) : std::nullopt;
      }
      add(fmt::format("share.{}", name), "%",
          scaled(ratio(sum(ransac).mean_parallel(), frame), 100));
    }
  }

  void add_latencies() {
    for (const FrameKind& kind : kFrameKinds) {
      Mean time;
      for (const LoggedFrame& frame : log_.frames())
        if (frame.result.source == kind.source && frame.result.keyframe == kind.keyframe &&
            !ran_both(frame))
          time.add(ms(frame.result.cycles));
      add(fmt::format("latency.{}", kind.key), "ms", time.value());
    }
    Mean parallel;
    Mean single;
    for (const LoggedFrame& frame : log_.frames()) {
      if (frame.result.source == PoseSource::First) continue;
      parallel.add(ms(frame.result.cycles));
      single.add(ms(frame.result.single_cycles));
    }
    add("latency.mean", "ms", parallel.value());
    add("latency.single_core", "ms", single.value());
  }

  void add_l1() {
    for (const PaperStage& paper : kPaperStages) {
      const auto stage = std::find_if(run_.stages.begin(), run_.stages.end(),
                                      [&](const StageResult& s) { return s.name == paper.stage; });
      const bool shown = stage != run_.stages.end() && stage->calls > 0;
      for (const auto& [suffix, peak] : {std::pair("single", &work::MemoryPeak::single),
                                         std::pair("parallel", &work::MemoryPeak::parallel)}) {
        const std::optional<Bytes> bytes =
            shown ? std::optional(stage->memory.*peak) : std::nullopt;
        add_memory(paper.key, fmt::format("l1_{}", suffix), fmt::format("occupation_{}", suffix),
                   bytes, run_.l1_size);
      }
    }
  }

  void add_l2() {
    for (const char* name : {"last keyframe", "pose graph", "optimiser"}) {
      const auto row = std::find_if(run_.l2.begin(), run_.l2.end(),
                                    [&](const L2Row& r) { return r.name == name; });
      std::optional<Bytes> bytes;
      if (row != run_.l2.end()) bytes = row->bytes;
      add_memory(key_of(name), "l2", "occupation", bytes, run_.l2_size);
    }
  }

  void add_memory(std::string_view owner, std::string_view kb, std::string_view percent,
                  std::optional<Bytes> bytes, Bytes size) {
    add(fmt::format("memory.{}.{}", owner, kb), "kB", bytes ? Value(kilo(*bytes)) : std::nullopt);
    add(fmt::format("memory.{}.{}", owner, percent), "%",
        bytes ? Value(percent_of_nominal(*bytes, size)) : std::nullopt);
  }

  const RunResult& run_;
  const FrameLog& log_;
  std::map<std::string_view, StageSum> sums_;
  std::vector<Quantity> list_;
};

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

bool ran_both(const LoggedFrame& frame) {
  return frame.find(vio::stages::kEpnp) != nullptr &&
         frame.find(vio::stages::kEightPoint) != nullptr;
}

std::vector<Quantity> quantities_of(const RunResult& run, const FrameLog& log) {
  return Quantities(run, log).all();
}

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
