#include "tools/app/report/run_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "sim/base/printable.h"
#include "sim/base/text.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/accuracy_text.h"
#include "tools/app/report/tables.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/result/summary.h"
#include "tools/app/result/verdict.h"
#include "tools/app/table/cell.h"
#include "tools/app/table/table.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kComma = ", ";

double ms(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

/// The text without its middle, if it is wider than that.
std::string without_middle(const std::string& text, int width) {
  if (display_width(text) <= width) return text;
  const auto at = [&](int column) {  // the byte at which that character begins
    std::size_t byte = 0;
    for (int c = -1; byte < text.size(); ++byte)
      if ((static_cast<unsigned char>(text[byte]) & 0xC0u) != 0x80u && ++c == column) break;
    return byte;
  };
  const int head = (width - 1) / 3;
  return text.substr(0, at(head)) + "…" + text.substr(at(display_width(text) - (width - 1 - head)));
}

/// The text, broken behind commas where it exceeds the width, and at blanks where a part is still
/// too wide; words stay whole. @param has_path  such a part loses its middle instead
std::string wrapped(const std::string& text, int width, bool has_path = false) {
  constexpr int kIndent = 2;
  std::vector<std::string> items;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(kComma, begin), text.size());
    const bool last = end == text.size();
    std::string item = text.substr(begin, end - begin) + (last ? "" : ",");
    if (has_path) item = without_middle(item, width - kIndent);
    if (display_width(item) <= width - kIndent)
      items.push_back(std::move(item));
    else
      for (std::string& word : base::split(item, ' ')) items.push_back(std::move(word));
    begin = last ? end : end + kComma.size();
  }
  return wrap(items, " ", kIndent, width) + '\n';
}

/// Empty if nothing was timed.
std::string frame_time_line(const RunResult& run) {
  const std::optional<FrameTimes> times = frame_times(run);
  if (!times) return {};
  const auto text = [&](const Banded& ns) {
    std::string words = fmt::format("{:.2f}", ns.value * 1e-6);
    if (times->has_bands) words += fmt::format(" ({:.3g}–{:.3g})", ns.low * 1e-6, ns.high * 1e-6);
    return words;
  };
  return fmt::format("frame time: mean {}, p99 {}, worst {} ms of {:.4g}", text(times->mean_ns),
                     text(times->p99_ns), text(times->worst_ns), ms(run.frame_period_ns));
}

/// "sustainable rate: 115 frames/s", and further figures that rows compute.
std::string row_figures(const RunResult& run) {
  std::vector<std::string> figures;
  for (const FigureRow& row : figure_rows())
    if (const auto value = row.of ? row.of(run) : std::nullopt)
      figures.push_back(
          fmt::format("{}: {:.3g} {}", row.title, *value * row.scale, row.title_unit));
  return fmt::format("{}", fmt::join(figures, kComma));
}

/// What a pose takes with waiting, where a camera runs; else empty.
std::string latency_line(const RunResult& run) {
  const auto camera = camera_figures(run);
  if (!camera) return {};
  const CameraFigures::Latencies& latency = camera->latency;
  return fmt::format(
      "latency: p50 {:.2f}, p99 {:.2f}, worst {:.2f} ms, deadline {:.4g} ms, dropped {}, late {}",
      ms(latency.p50_ns), ms(latency.p99_ns), ms(latency.max_ns), ms(run.frame_period_ns),
      camera->dropped, camera->late);
}

std::string memory_line(const RunResult& run) {
  const StageResult* worst = nullptr;
  for (const StageResult& stage : run.stages)
    if (!stage.on_controller &&
        (worst == nullptr || stage.memory.parallel > worst->memory.parallel))
      worst = &stage;
  std::string text = "memory:";
  if (worst != nullptr)
    text += fmt::format(" L1 {} in {},", of_memory(worst->memory.parallel, run.l1_size),
                        printable(worst->name));
  Bytes l2;
  for (const L2Row& row : run.l2) l2 += row.bytes;
  text += fmt::format(" L2 {}", of_memory(l2, run.l2_size));
  Bytes external;
  for (const L2Row& row : run.external) external += row.bytes;
  if (external > Bytes(0))
    text += fmt::format(", external {}", of_memory(external, run.external_size));
  return text;
}

/// "triangulation 3.1 tiles (3.9 kB, 1.2 more)": more than a program with room would move.
std::string tiles_of(const StageResult& stage, double frames) {
  const work::Transferred& moved = stage.transfers;
  const auto kb = [&](Bytes bytes) { return static_cast<double>(bytes.count()) * 1e-3 / frames; };
  return fmt::format("{} {:.1f} tiles ({:.1f} kB, {:.1f} more)", printable(stage.name),
                     static_cast<double>(moved.tiles) / frames, kb(moved.tile_bytes),
                     kb(moved.tile_bytes_more));
}

/// What has no room in a memory and passes through it in tiles, how much more that is than a
/// program with room would move, and how long cores wait for the DMA
/// in these stages; empty if all has room.
std::string tiles_line(const RunResult& run) {
  const auto frames = static_cast<double>(std::max<std::size_t>(1, run.frames.size()));
  std::vector<std::string> texts;
  double waited_s = 0;
  for (const StageResult& stage : run.stages) {
    if (stage.transfers.tiles == 0) continue;
    texts.push_back(tiles_of(stage, frames));
    const int cores = stage.on_controller ? 1 : run.cores;
    waited_s += stage.account.team[sim::Mechanism::Transfer] / cores /
                static_cast<double>(clock_of(run, stage).count());
  }
  if (texts.empty()) return {};
  texts.back() +=
      fmt::format(" a frame, {:.2f} ms of it waiting for the DMA", waited_s * 1e3 / frames);
  return fmt::format("in tiles: {}", fmt::join(texts, kComma));
}

/// Empty where the platform has no energy figures.
std::string energy_line(const RunResult& run) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy || !energy->per_frame() || !energy->mean_power()) return {};
  const auto banded = [](const auto& figure, double unit) {
    return fmt::format("{:.3f} ({:.3f}–{:.3f})", figure.value.count() / unit,
                       figure.low().count() / unit, figure.high().count() / unit);
  };
  return fmt::format("energy: {} mJ per frame, mean power {} mW",
                     banded(*energy->per_frame(), 1e-3), banded(*energy->mean_power(), 1e-3));
}

/// Alignment, matched poses and completion: the protocol as far as a line takes it.
std::string short_protocol(const traces::Evaluation& ate) {
  return fmt::format("{}, {} of {} poses matched, completion {:.1f} %, {:.2f} m of path",
                     ate.protocol.substr(0, ate.protocol.find(kComma)), ate.matched, ate.estimates,
                     100 * ate.completion, ate.path_length_m);
}

/// Why there is no ATE, where nothing made the poses incomparable.
std::string_view without_ate(const RunResult& run) {
  return run.trajectory.size() < kFewestPoses ? "too few poses to align"
                                              : "no ground truth in the data";
}

std::vector<std::string> trajectory_lines(const RunResult& run) {
  if (!has_poses(run)) return {};
  const std::int64_t restarts = map_restarts(run);
  std::string again = restarts > 0 ? fmt::format(", restarts of the map {}", restarts) : "";
  const std::int64_t initialising = std::count_if(
      run.frames.begin(), run.frames.end(),
      [](const FrameResult& frame) { return frame.source == PoseSource::Initialising; });
  if (initialising > 0) again += fmt::format(", initialising for {} frames", initialising);
  if (const std::optional<double> deviation = figures_of(run).map.path_deviation_m)
    again += fmt::format(", path uncertain by {} m", readable(*deviation, 2));
  const std::string length = fmt::format("trajectory: {} poses, {}", run.trajectory.size(),
                                         metres(path_length(run.trajectory), 2));
  if (const std::string why = why_incomparable(run); !why.empty())
    return {length + again, "ATE: none: " + why};
  if (!run.ate) return {fmt::format("{}{}, {}", length, again, without_ate(run))};
  std::string text = "trajectory: ATE " + metres(run.ate->translation.rmse, 3);
  if (text.ends_with(kDiverged)) return {text + again, "  " + short_protocol(*run.ate)};
  text += " RMSE";
  if (run.ate->located_rmse_m)
    text += fmt::format(" ({} without guesses)", metres(*run.ate->located_rmse_m, 3));
  text += fmt::format(", {} worst", metres(run.ate->translation.max, 3));
  if (const auto attitude = traces::attitude_errors(*run.ate))
    text += fmt::format(", tilt {:.1f}°, heading {:.1f}°{}", attitude->tilt_rmse_deg,
                        attitude->heading_rmse_deg,
                        attitude->is_gravity_aligned() ? "" : ", not gravity-aligned");
  return {text + again, "  " + short_protocol(*run.ate)};
}

/// The `rows` stages with the most cycles, in the order of the workload.
std::string stage_lines(const RunResult& run, int rows, int width) {
  std::vector<const StageResult*> stages;
  for (const StageResult& stage : run.stages) stages.push_back(&stage);
  const int all = static_cast<int>(stages.size());
  std::string left_out;
  if (all > rows) {
    std::vector<const StageResult*> by_cycles = stages;
    std::stable_sort(by_cycles.begin(), by_cycles.end(),
                     [](const auto* a, const auto* b) { return a->parallel > b->parallel; });
    const int shown = std::max(rows - 1, 1);
    const auto rest = by_cycles.begin() + shown;
    std::erase_if(stages, [&](const auto* stage) {
      return std::find(rest, by_cycles.end(), stage) != by_cycles.end();
    });
    left_out = fmt::format("… {} more with fewer cycles\n", all - shown);
  }
  return terminal_text(stages_of(run, stages, ""), width) + left_out + unmeasured_note(run);
}

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

std::int64_t count_of(const RunResult& run, PoseSource source) {
  return std::count_if(run.frames.begin(), run.frames.end(),
                       [&](const FrameResult& frame) { return frame.source == source; });
}

/// Why its error is not that of a run on a chip. Of what has no optimiser beside it, nothing.
std::string native_line(const RunResult& run) {
  if (!run.ate || run.optimiser_published == 0) return {};
  return "natively the optimiser takes no time: each frame sees its newest result, which on a chip "
         "comes frames later, so errors differ";
}

}  // namespace

std::string verdict(const RunResult& run) {
  const Verdicts verdicts = figures_of(run).verdicts;
  if (verdicts.list.empty() && !run.frames.empty())
    return "verdict: none, as neither times nor poses are known";
  return "verdict: " + verdicts.text();
}

std::string run_summary(const std::string& heading, const RunResult& run, int width, int others) {
  std::vector<std::string> below;
  if (run.timed)
    below = {fmt::format("{}{}{}", frame_time_line(run), kComma, row_figures(run)),
             latency_line(run), memory_line(run), tiles_line(run), energy_line(run)};
  else
    below = {frame_summary(run).substr(0, frame_summary(run).find('\n')), row_figures(run),
             native_line(run)};
  for (std::size_t i = 0; i < run.notes.size(); ++i)
    below.insert(below.begin() + 1 + static_cast<std::ptrdiff_t>(i), printable(run.notes[i]));
  for (std::string& line : trajectory_lines(run)) below.push_back(std::move(line));
  std::string end;
  for (std::string& line : below) {
    if (line.ends_with('\n')) line.pop_back();
    if (!line.empty()) end += wrapped(line, width);
  }
  end += "more: --tables all, or some of them\n";
  std::string text = wrapped(heading, width, true) + '\n';
  text += wrapped(verdict(run), width);
  if (!run.timed) return text + end;
  constexpr int kTitleRuleFolderAndNext = 4;
  const auto lines = std::count(text.begin(), text.end(), '\n') +
                     std::count(end.begin(), end.end(), '\n') + kTitleRuleFolderAndNext + others;
  return text + stage_lines(run, kScreenLines - static_cast<int>(lines), width) + end;
}

std::string latency_table(const RunResult& run, int width) {
  const auto period_ns = static_cast<double>(run.frame_period_ns);
  using S = const Scenario&;
  const auto worst = [](S s) {
    return s.frames > 0 ? std::optional(static_cast<double>(s.worst_latency_ns)) : std::nullopt;
  };
  const auto percent = [=](std::optional<double> ns) {
    return figure_text(ns ? std::optional(100.0 * *ns / period_ns) : std::nullopt, 1);
  };
  const auto ms = [](std::optional<double> ns) { return figure_text(scaled(ns, 1e-6), 2); };
  const Columns<Scenario> table{
      {{"pose from", kLeft}, [](S s) { return s.name; }},
      {{"frames"}, [](S s) { return s.frames; }},
      {{"mean ms"}, [=](S s) { return ms(s.mean_latency_ns()); }},
      {{"worst ms"}, [=](S s) { return ms(worst(s)); }},
      {{"mean/period %", kRight, 1}, [=](S s) { return percent(s.mean_latency_ns()); }},
      {{"worst/period %"}, [=](S s) { return percent(worst(s)); }},
      {{"over period"}, [](S s) { return s.over_period; }}};
  return fmt::format(
             "frame latency, from the camera's frame to its pose (frame period {:.2f} ms)\n",
             period_ns * 1e-6) +
         terminal_text(table_of(table, scenarios(run)), width) + waiting_line(run);
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
  auto all = vio::kPoseSources;
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.rank < b.rank; });
  for (const vio::PoseSourceInfo& info : all)
    if (const std::int64_t frames = count_of(run, info.source); frames > 0)
      sources.push_back(fmt::format("{} {}", info.words, frames));
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
  if (!has_poses(run)) return {};
  const std::string length = metres(path_length(run.trajectory), 2);
  std::string text = fmt::format("trajectory: {} poses, {}{}\n", run.trajectory.size(), length,
                                 length == kDiverged ? "" : " long");
  if (run.poses_left_out > 0)
    text += fmt::format("            {} more are NaN and are left out\n", run.poses_left_out);
  if (const std::string why = why_incomparable(run); !why.empty())
    return text + "ATE: none: " + why + '\n';
  if (!run.ate) return text + fmt::format("ATE: {}\n", without_ate(run));
  return text + ate_text(*run.ate);
}

std::string host_line(const RunResult& run) {
  std::string text =
      fmt::format("host: {} frames in {:.1f} s", run.frames.size(), run.host_seconds);
  if (run.host_seconds > 0 && !run.frames.empty()) {
    const double flown_s = static_cast<double>(run.frames.back().t_ns - run.frames.front().t_ns +
                                               run.frame_period_ns) *
                           1e-9;
    text += fmt::format(" ({:.1f} frames/s, {} times real time)",
                        static_cast<double>(run.frames.size()) / run.host_seconds,
                        readable(flown_s / run.host_seconds, 1));
  }
  return text + '\n';
}

std::string map_warning(const RunResult& run) {
  if (!has_poses(run)) return {};
  const RunVerdict verdict = map_verdict(figures_of(run).map);
  return verdict.grade <= Grade::unknown ? "" : fmt::format("warning: {}\n", verdict.text());
}

}  // namespace leviosim::tools
