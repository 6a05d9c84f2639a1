#include "tools/app/report/frame_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tools/app/report/accuracy.h"
#include "tools/app/report/number_text.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/summary.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

std::string waiting_line(const RunResult& run) {
  const Waiting waiting = frames_that_waited(run);
  return fmt::format("frames that waited for the front end: {}, the longest {:.2f} ms\n",
                     waiting.frames, static_cast<double>(waiting.longest_ns) * 1e-6);
}

double mean_of(const RunResult& run, int FrameResult::*field) {
  double sum = 0;
  for (const FrameResult& frame : run.frames) sum += frame.*field;
  return run.frames.empty() ? 0 : sum / static_cast<double>(run.frames.size());
}

/// In words, as they stand in the line of the frames: all there are, so that they add up.
constexpr std::array<std::pair<PoseSource, std::string_view>, vio::kPoseSources.size()> kSources{{
    {PoseSource::Tracked, "tracked"},
    {PoseSource::Epnp, "EPnP"},
    {PoseSource::EightPoint, "8-point"},
    {PoseSource::Predicted, "predicted"},
    {PoseSource::Initialising, "initialising"},
    {PoseSource::Kept, "pose kept"},
    {PoseSource::First, "first of a map"},
}};

std::int64_t count_of(const RunResult& run, PoseSource source) {
  return std::count_if(run.frames.begin(), run.frames.end(),
                       [&](const FrameResult& frame) { return frame.source == source; });
}

}  // namespace

std::string latency_table(const RunResult& run, int width) {
  const auto period_ns = static_cast<double>(run.frame_period_ns);
  TextTable table({{"pose from", TextTable::Align::Left},
                   {"frames"},
                   {"mean ms"},
                   {"worst ms"},
                   {"mean/period %", TextTable::Align::Right, 1},
                   {"worst/period %"},
                   {"over period"}});
  const auto percent = [&](std::optional<double> ns) {
    return figure_text(ns ? std::optional(100.0 * *ns / period_ns) : std::nullopt, 1);
  };
  const auto ms = [](std::optional<double> ns) {
    return figure_text(ns ? std::optional(*ns * 1e-6) : std::nullopt, 2);
  };
  for (const Scenario& scenario : scenarios(run)) {
    std::optional<double> worst;
    if (scenario.frames > 0) worst = static_cast<double>(scenario.worst_latency_ns);
    const std::optional<double> average = scenario.mean_latency_ns();
    table.add({std::string(scenario.name), fmt::format("{}", scenario.frames), ms(average),
               ms(worst), percent(average), percent(worst),
               fmt::format("{}", scenario.over_period)});
  }
  return fmt::format(
             "frame latency, from the camera's frame to its pose (frame period {:.2f} ms)\n",
             period_ns * 1e-6) +
         table.str(width) + waiting_line(run);
}

std::string camera_summary(const RunResult& run) {
  const std::optional<CameraFigures> figures = camera_figures(run);
  if (!figures) return {};
  const auto counted = [&](std::int64_t frames) {
    return fmt::format("{} ({:.1f} %)", frames, 100 * figures->share_of(frames));
  };
  const auto ms = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; };
  const CameraFigures::Latencies& latency = figures->latency;
  return fmt::format(
      "closed loop: camera at {:g} frames/s; {}\n"
      "frames: {} arrived, {} processed, {} dropped; {} late, so {} missed the deadline of a "
      "period\n"
      "        {} waited; most frames found in the camera's two buffers: {}\n"
      "latency [ms]: p50 {:.2f}, p95 {:.2f}, p99 {:.2f}, worst {:.2f}; the period is {:.2f}\n",
      run.camera->fps, info_of(run.camera->deadline).description, figures->arrived,
      figures->processed, counted(figures->dropped), counted(figures->late),
      counted(figures->missed()), counted(figures->waited), figures->most_found, ms(latency.p50_ns),
      ms(latency.p95_ns), ms(latency.p99_ns), ms(latency.max_ns), ms(run.frame_period_ns));
}

std::string frame_summary(const RunResult& run) {
  std::vector<std::string> sources;
  for (const auto& [source, name] : kSources)
    if (const std::int64_t frames = count_of(run, source); frames > 0)
      sources.push_back(fmt::format("{} {}", name, frames));
  const std::int64_t keyframes = std::count_if(run.frames.begin(), run.frames.end(),
                                               [](const FrameResult& f) { return f.keyframe; });
  std::string text = fmt::format("frames: {}", run.frames.size());
  if (!sources.empty()) text += fmt::format(" ({})", fmt::join(sources, ", "));
  text += fmt::format(
      ", keyframes {}, restarts of the map {}\n"
      "        per frame {:.1f} features, {:.1f} world matches, {:.1f} frame matches, "
      "{:.1f} landmarks\n",
      keyframes, map_restarts(run), mean_of(run, &FrameResult::features),
      mean_of(run, &FrameResult::world_matches), mean_of(run, &FrameResult::frame_matches),
      mean_of(run, &FrameResult::landmarks));
  if (run.timed)
    text += fmt::format("optimiser: {} results published, still busy at the start of {} frames\n",
                        run.optimiser_published, run.optimiser_late);
  return text;
}

std::string trajectory_summary(const RunResult& run) {
  std::string text = fmt::format("trajectory: {} poses, {:.2f} m long\n", run.trajectory.size(),
                                 path_length(run.trajectory));
  if (run.poses_left_out > 0)
    text += fmt::format("            {} more are NaN and are left out\n", run.poses_left_out);
  if (const std::string why = why_incomparable(run); !why.empty())
    return text + "ATE: none: " + why + '\n';
  if (!run.ate) return text + "ATE: no ground truth in the data\n";
  return text + ate_text(*run.ate);
}

std::string host_line(const RunResult& run) {
  std::string text =
      fmt::format("host: {} frames in {:.1f} s", run.frames.size(), run.host_seconds);
  if (run.host_seconds > 0)
    text += fmt::format(" ({:.1f} frames/s)",
                        static_cast<double>(run.frames.size()) / run.host_seconds);
  return text + '\n';
}

std::string map_warning(const RunResult& run) {
  const RunVerdict verdict = map_verdict(map_signs(run));
  return verdict.grade <= Grade::unknown ? "" : fmt::format("warning: {}\n", verdict.text());
}

}  // namespace leviosim::tools
