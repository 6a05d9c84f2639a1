#include "tools/app/result/run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/app/result/summary.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

std::optional<double> sustainable_rate(const RunResult& run) {
  const std::optional<FrameTimes> times = frame_times(run);
  return times ? std::optional(times->sustainable_rate()) : std::nullopt;
}

constexpr std::array kFigureRows{
    FigureRow{"frame.time.mean", "ns", "frame time mean", "frame time, mean", "ms", 1e-6},
    FigureRow{"frame.time.p99", "ns", "frame time p99", "frame time, 99 %", "ms", 1e-6},
    FigureRow{"frame.time.worst", "ns", "frame time worst", "frame time, worst", "ms", 1e-6},
    FigureRow{"frame.sustainable_rate", "1/s", "sustainable rate", "sustainable rate", "frames/s",
              1, true, "frames that the chip can process, by their mean time", sustainable_rate},
    FigureRow{"frame.missed_share", "1", "missed", "frames that missed", "%", 100},
    FigureRow{"frame.latency.mean", "ns", "frame latency mean"},
    FigureRow{"frame.latency.p50", "ns", "frame latency p50"},
    FigureRow{"frame.latency.p95", "ns", "frame latency p95"},
    FigureRow{"frame.latency.p99", "ns", "frame latency p99", "latency, 99 %", "ms", 1e-6},
    FigureRow{"frame.latency.worst", "ns", "frame latency worst", "latency, worst", "ms", 1e-6},
    FigureRow{"frame.cycles.single.mean", "cycles", "frame cycles on one core", "frame on one core",
              "kcycles", 1e-3},
    FigureRow{"frame.cycles.parallel.mean", "cycles", "frame cycles", "frame on N cores", "kcycles",
              1e-3},
    FigureRow{"run.cluster_clock", "Hz", "", "clock of the cluster", "MHz", 1e-6},
    FigureRow{"memory.l1.peak", "byte", "L1 peak", "L1 peak", "kB", 1e-3},
    FigureRow{"memory.l2.peak", "byte", "L2 peak", "L2 peak", "kB", 1e-3},
    FigureRow{"energy.frame", "mJ", "energy per frame", "energy of a frame", "mJ", 1},
    FigureRow{"energy.mean_power", "mW", "mean power", "mean power", "mW", 1},
    FigureRow{"accuracy.ate.rmse", "m", "ATE", "ATE (RMSE)", "m", 1},
    FigureRow{"accuracy.ate.located", "m", "located ATE", "ATE without guesses", "m", 1},
    FigureRow{"accuracy.completion", "1", "completion"},
    FigureRow{"verdict.time", "time verdict", "time verdict"},
    FigureRow{"verdict.memory", "memory verdict", "memory verdict"},
    FigureRow{"verdict.map", "map verdict", "map verdict"},
};

RecordedFrame recorded(const FrameResult& frame) {
  RecordedFrame row;
  row.number = frame.index;
  row.t_ns = frame.t_ns;
  row.source = frame.source;
  row.features = frame.features;
  row.map_restarts = frame.map_restarts;
  row.health = frame.health;
  row.health_reasons = frame.health_reasons;
  row.path_mm = frame.path_mm;
  row.path_deviation_mm = frame.path_deviation_mm;
  row.state = frame.pose_state();
  row.at_rest = frame.at_rest > 0;
  return row;
}

/// The longest time from a pose to the last of its successors that all come from `source`.
double longest_s(const std::vector<RecordedFrame>& frames, PoseSource source) {
  std::int64_t longest_ns = 0;
  for (std::size_t i = 1, known = 0; i < frames.size(); ++i) {
    if (frames[i].source != source)
      known = i;
    else
      longest_ns = std::max(longest_ns, frames[i].t_ns - frames[known].t_ns);
  }
  return static_cast<double>(longest_ns) * 1e-9;
}

void add_operations(RunFigures& run) {
  for (const StageName& stage : run.stages) {
    const std::string ops = fmt::format("stages.{}.ops.", stage.key);
    std::optional<double> sum;
    for (const Statistic& s : run.statistics)
      if (s.value && s.name.starts_with(ops)) sum = sum.value_or(0) + *s.value;
    if (sum)
      run.statistics.push_back({fmt::format("stages.{}.operations", stage.key), "1",
                                "operations of all kinds, of all calls", sum});
  }
}

void add_memory_statistics(RunFigures& run) {
  std::optional<double> l1;
  for (const StageName& stage : run.stages) {
    const auto peak = run.value(fmt::format("stages.{}.memory.parallel", stage.key));
    if (!stage.on_controller && peak) l1 = std::max(l1.value_or(0), *peak);
  }
  std::optional<double> l2;
  for (const Statistic& s : run.statistics)
    if (s.name.starts_with("memory.l2.") && s.name.ends_with(".bytes") && s.value)
      l2 = l2.value_or(0) + *s.value;
  if (l1) run.statistics.push_back({"memory.l1.peak", "byte", "highest occupation of L1", l1});
  if (l2) run.statistics.push_back({"memory.l2.peak", "byte", "occupation of L2", l2});
}

}  // namespace

std::span<const FigureRow> figure_rows() { return kFigureRows; }

const Statistic* RunFigures::find(std::string_view statistic) const {
  const auto it = std::find_if(statistics.begin(), statistics.end(),
                               [&](const Statistic& s) { return s.name == statistic; });
  return it == statistics.end() ? nullptr : &*it;
}

std::optional<double> RunFigures::value(std::string_view statistic) const {
  const Statistic* found = find(statistic);
  return found == nullptr ? std::nullopt : found->value;
}

std::vector<RecordedFrame> recorded_frames(const RunResult& run) {
  std::vector<RecordedFrame> frames;
  auto frame = run.frames.begin();
  const auto next = [&] {
    if (frame != run.frames.end()) frames.push_back(recorded(*frame++));
  };
  if (!run.camera)
    while (frame != run.frames.end()) next();
  else
    for (const soc::Delivery& delivery : run.camera->deliveries) {
      if (!delivery.dropped) {
        next();
        continue;
      }
      RecordedFrame& dropped = frames.emplace_back();
      dropped.number = delivery.frame;
      dropped.t_ns = delivery.t_ns;
    }
  return frames;
}

namespace {

/// The number of the first of the last frames that all are so; absent if the last one is not.
template <class Is>
std::optional<int> since(const std::vector<RecordedFrame>& frames, const Is& is) {
  const auto last_other = std::find_if_not(frames.rbegin(), frames.rend(), is);
  return last_other == frames.rbegin() ? std::nullopt : std::optional(last_other.base()->number);
}

void add_guesses(const std::vector<RecordedFrame>& frames, MapSigns& signs) {
  const auto guessed = [](const RecordedFrame& f) {
    return f.state == vio::PoseState::Initialising;
  };
  signs.guesses = std::count_if(frames.begin(), frames.end(), guessed);
  const auto located = std::find_if_not(frames.begin(), frames.end(), guessed);
  if (signs.guesses > 0 && located != frames.end() && located - frames.begin() == signs.guesses)
    signs.located_from = located->number;
}

/// The frames that are so, from the first to the last.
template <class Is>
FrameSpan span_of(const std::vector<RecordedFrame>& frames, const Is& is) {
  FrameSpan span;
  for (const RecordedFrame& frame : frames) {
    if (!is(frame)) continue;
    if (span.frames++ == 0) span.first = frame.number;
    span.last = frame.number;
  }
  return span;
}

/// Why the estimator does not trust its map at the end, and did not before.
void add_reasons(const std::vector<RecordedFrame>& frames, MapSigns& signs) {
  signs.health = frames.back().health;
  signs.health_reasons = frames.back().health_reasons;
  for (std::size_t i = 0; i < signs.reason_since.size(); ++i) {
    const auto holds = [&](const RecordedFrame& f) { return (f.health_reasons >> i & 1) != 0; };
    signs.reason_since[i] = since(frames, holds).value_or(0);
    const FrameSpan span = span_of(frames, holds);
    if (span.frames > 0 && !holds(frames.back())) signs.past_reasons[i] = span;
  }
  signs.lost = span_of(frames, [](const RecordedFrame& f) {
    return f.health == static_cast<int>(vio::Health::lost);
  });
}

/// How well the estimator knows the length of its path; nothing where it is not judged.
void add_path(const RecordedFrame& last, MapSigns& signs) {
  if (last.path_mm == 0 && last.path_deviation_mm == 0) return;
  signs.own_path_m = 1e-3 * last.path_mm;
  signs.path_deviation_m = 1e-3 * last.path_deviation_mm;
}

/// What frames and the ground truth say.
MapSigns map_signs(const std::vector<RecordedFrame>& frames, const TruthSigns& truth,
                   std::int64_t poses_left_out) {
  MapSigns signs;
  signs.poses_left_out = poses_left_out;
  signs.truth = truth;
  std::vector<RecordedFrame> processed;
  for (const RecordedFrame& frame : frames)
    if (frame.source) processed.push_back(frame);
  if (processed.empty()) return signs;
  signs.kept_s = longest_s(processed, PoseSource::Kept);
  signs.initialising_s = longest_s(processed, PoseSource::Initialising);
  const RecordedFrame& last = processed.back();
  signs.ends_without_pose =
      last.source == PoseSource::Kept || last.source == PoseSource::Initialising;
  signs.duration_s = static_cast<double>(last.t_ns - processed.front().t_ns) * 1e-9;
  add_reasons(processed, signs);
  add_path(last, signs);
  double features = 0;
  for (const RecordedFrame& frame : processed) {
    features += frame.features;
    signs.restarts += frame.map_restarts;
  }
  signs.at_rest_since = since(processed, [](const RecordedFrame& f) { return f.at_rest; });
  add_guesses(processed, signs);
  signs.features = features / static_cast<double>(processed.size());
  return signs;
}

}  // namespace

const StageName* fullest_stage(const RunFigures& run) {
  const StageName* fullest = nullptr;
  double most = 0;
  for (const StageName& stage : run.stages) {
    const auto peak = run.value(fmt::format("stages.{}.memory.parallel", stage.key));
    if (stage.on_controller || !peak || *peak <= most) continue;
    fullest = &stage;
    most = *peak;
  }
  return fullest;
}

double deadline_ns(const RunFigures& run) {
  const double rate = run.value("camera.rate").value_or(0);
  return rate > 0 ? 1e9 / rate : run.value("run.frame_period").value_or(0);
}

void complete(RunFigures& run, const std::vector<RecordedFrame>& frames) {
  add_memory_statistics(run);
  add_operations(run);
  const std::optional<double> poses = run.value("trajectory.poses");
  const double left_out = poses ? run.value("frames.count").value_or(0) - *poses : 0;
  run.map = map_signs(frames,
                      {run.value("accuracy.ate.rmse"), run.value("accuracy.truth_length"),
                       run.value("accuracy.size_ratio"), run.value("accuracy.ate.located"),
                       run.value("accuracy.tilt.rmse")},
                      std::max<std::int64_t>(0, std::llround(left_out)));
  run.map.has_poses = poses.has_value();
  if (run.map.own_path_m) {
    run.statistics.push_back(
        {"map.path", "m", "length of the path as the estimator knows it", run.map.own_path_m});
    run.statistics.push_back({"map.path_deviation", "m",
                              "standard deviation of that length, as the estimator knows it",
                              run.map.path_deviation_m});
  }
  if (run.map.at_rest_since)
    run.statistics.push_back({"map.at_rest_since", "1",
                              "the frame from which on the vehicle rests until the end",
                              *run.map.at_rest_since});
  run.verdicts = verdicts_of(run);
  for (const RunVerdict& verdict : run.verdicts.list)
    run.statistics.push_back({fmt::format("verdict.{}", verdict.about),
                              fmt::format("{} verdict", verdict.about),
                              "0 is the best, 2 the worst", severity(verdict.grade)});
}

}  // namespace leviosim::tools
