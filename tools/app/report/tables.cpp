#include "tools/app/report/tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/base/printable_text.h"
#include "sim/chip/accelerator.h"
#include "tools/app/report/accuracy.h"
#include "tools/app/report/energy_tables.h"
#include "tools/app/report/text_table.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

constexpr int kWidth = 100;

std::string number(std::optional<double> value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : kNothing;
}

std::string kilo(std::optional<double> value, int decimals) {
  return number(value ? std::optional(*value / 1000.0) : std::nullopt, decimals);
}

std::string kilobytes(Bytes bytes) { return kilo(static_cast<double>(bytes.count()), 1); }

std::string on_cores(int cores) { return cores == 1 ? "1 core" : fmt::format("{} cores", cores); }

std::string milliseconds_text(std::optional<double> cycles, Hertz clock) {
  return number(cycles ? std::optional(milliseconds(*cycles, clock)) : std::nullopt, 3);
}

/// Columns of the table of breakdowns, in its order.
constexpr std::array<std::string_view, 11> kBreakdownColumns{
    "useful", "served",    "queue", "I-cache",  "FPU",   "divider",
    "banks",  "imbalance", "sync",  "transfer", "serial"};

/// What stands in a column, summed up. Absent for a column that no part belongs to.
std::optional<double> sum_of(std::string_view column, const std::vector<BreakdownPart>& parts,
                             const sim::CycleBreakdown& breakdown) {
  std::optional<double> sum;
  for (const BreakdownPart& part : parts)
    if (part.column == column) sum = sum.value_or(0) + part.of(breakdown);
  return sum;
}

/// Those that there are on the cluster.
std::vector<BreakdownPart> cluster_parts(const RunResult& run) {
  std::vector<BreakdownPart> parts(kBreakdownParts.begin(), kBreakdownParts.end());
  if (run.timed && sim::has_accelerators(run.chip.cluster.accelerators))
    parts.insert(parts.end(), kAcceleratorParts.begin(), kAcceleratorParts.end());
  return parts;
}

std::vector<std::string> breakdown_cells(const std::vector<BreakdownPart>& parts,
                                         const sim::CycleBreakdown& breakdown) {
  std::vector<double> sums;
  for (const std::string_view column : kBreakdownColumns)
    if (const auto sum = sum_of(column, parts, breakdown)) sums.push_back(*sum);
  if (!(breakdown.total() > 0)) return std::vector<std::string>(sums.size() + 1, kNothing);
  std::vector<std::string> cells;
  for (const double percent : tenths_of_percent(sums)) cells.push_back(number(percent, 1));
  cells.push_back(number(breakdown.total() * 1e-6, 1));
  return cells;
}

/// "image 19.2", "scratch ×8 36.0", and the names of what is too small for the unit.
std::vector<std::string> block_list(const std::vector<work::Block>& blocks) {
  constexpr Bytes kShownSize{50};  // the smallest that rounds to 0.1 kB
  std::vector<std::string> items;
  std::vector<std::string> small;
  for (const BlockGroup& group : grouped(blocks)) {
    std::string name = printable(group.name);
    if (group.copies > 1) name += fmt::format(" ×{}", group.copies);
    if (group.bytes < kShownSize)
      small.push_back(std::move(name));
    else
      items.push_back(fmt::format("{} {}", name, kilobytes(group.bytes)));
  }
  if (!small.empty()) small.front() = "below 0.1: " + small.front();
  items.insert(items.end(), small.begin(), small.end());
  return items;
}

/// A row of the memory table and the blocks it stands for.
struct Occupant {
  std::string name;  ///< printable
  const char* memory;
  Bytes size;  ///< of the memory
  std::optional<Bytes> single;
  std::optional<Bytes> parallel;
  const std::vector<work::Block>* blocks;
};

std::vector<Occupant> occupants(const RunResult& run) {
  std::vector<Occupant> all;
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller) continue;  // its memory is L2, below
    Occupant row{printable(stage.name), "L1", run.l1_size, {}, {}, &stage.memory.blocks};
    if (stage.calls > 0) {
      row.single = stage.memory.single;
      row.parallel = stage.memory.parallel;
    }
    all.push_back(row);
  }
  for (const L2Row& part : run.l2)
    all.push_back({printable(part.name), "L2", run.l2_size, part.bytes, {}, &part.blocks});
  return all;
}

std::string blocks_at_peak(const std::vector<Occupant>& rows) {
  int indent = 0;
  for (const Occupant& row : rows) indent = std::max(indent, display_width(row.name) + 4);
  std::string text = "blocks alive at the peak [kB]\n";
  for (const Occupant& row : rows) {
    const std::vector<std::string> items = block_list(*row.blocks);
    const int padding = indent - 2 - display_width(row.name);
    text += fmt::format("  {}{}{}\n", row.name, std::string(static_cast<std::size_t>(padding), ' '),
                        items.empty() ? kNothing : wrap(items, " · ", indent, kWidth));
  }
  return text;
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

}  // namespace

std::vector<double> tenths_of_percent(const std::vector<double>& parts) {
  const double total = std::accumulate(parts.begin(), parts.end(), 0.0);
  std::vector<double> tenths(parts.size(), 0.0);
  if (!(total > 0)) return tenths;
  std::vector<std::size_t> by_remainder(parts.size());
  std::iota(by_remainder.begin(), by_remainder.end(), std::size_t{0});
  const auto exact = [&](std::size_t i) { return 1000.0 * parts[i] / total; };
  for (const std::size_t i : by_remainder) tenths[i] = std::floor(exact(i));
  std::stable_sort(by_remainder.begin(), by_remainder.end(), [&](std::size_t a, std::size_t b) {
    return exact(a) - tenths[a] > exact(b) - tenths[b];
  });
  double missing = 1000.0 - std::accumulate(tenths.begin(), tenths.end(), 0.0);
  for (std::size_t k = 0; missing > 0 && k < by_remainder.size(); ++k, --missing)
    ++tenths[by_remainder[k]];
  for (double& value : tenths) value /= 10.0;
  return tenths;
}

std::string stage_table(const RunResult& run) {
  TextTable table({{"stage", kLeft},
                   {"call", kLeft},
                   {"calls"},
                   {"kcycles, 1 core"},
                   {"kcycles, " + on_cores(run.cores)},
                   {"speed-up"},
                   {"ms"},
                   {"worst ms"}});
  for (const StageResult& stage : run.stages) {
    const std::optional<double> parallel = mean(stage.parallel, stage.calls);
    const std::optional<double> worst = mean(stage.worst_parallel, stage.calls > 0 ? 1 : 0);
    const Hertz clock = clock_of(run, stage);
    table.add({stage.on_controller ? stage.name + " ¹" : stage.name, stage.unit,
               fmt::format("{}", stage.calls), kilo(mean(stage.single, stage.calls), 2),
               kilo(parallel, 2), number(speedup(stage), 2), milliseconds_text(parallel, clock),
               milliseconds_text(worst, clock)});
  }
  const bool any_on_controller = std::any_of(run.stages.begin(), run.stages.end(),
                                             [](const StageResult& s) { return s.on_controller; });
  return fmt::format("stages (mean of a call; ms on {})\n", on_cores(run.cores)) + table.str() +
         (any_on_controller ? "¹ on the fabric controller, which is one core\n" : "");
}

std::string breakdown_table(const RunResult& run) {
  std::vector<TextTable::Column> columns{{"stage", kLeft}};
  const std::vector<BreakdownPart> parts = cluster_parts(run);
  for (const std::string_view column : kBreakdownColumns)
    if (sum_of(column, parts, {})) columns.push_back({std::string(column)});
  columns.push_back({"core-Mcycles"});
  TextTable table(std::move(columns));
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller) continue;
    std::vector<std::string> cells = breakdown_cells(parts, stage.breakdown);
    cells.insert(cells.begin(), stage.name);
    table.add(std::move(cells));
  }
  return fmt::format("where the core-cycles go on {} [%]\n", on_cores(run.cores)) + table.str() +
         "serial: the team idles while the master works alone; imbalance: waiting for the slowest "
         "core of a fork\n";
}

std::string latency_table(const RunResult& run) {
  const auto period_ns = static_cast<double>(run.frame_period_ns);
  TextTable table({{"pose from", kLeft},
                   {"frames"},
                   {"mean ms"},
                   {"worst ms"},
                   {"mean/period %"},
                   {"worst/period %"},
                   {"over period"}});
  const auto percent = [&](std::optional<double> ns) {
    return number(ns ? std::optional(100.0 * *ns / period_ns) : std::nullopt, 1);
  };
  const auto ms = [](std::optional<double> ns) {
    return number(ns ? std::optional(*ns * 1e-6) : std::nullopt, 2);
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
         table.str() + waiting_line(run);
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

std::string memory_table(const RunResult& run) {
  TextTable table({{"peak", kLeft},
                   {"memory", kLeft},
                   {"kB, 1 core"},
                   {"kB, " + on_cores(run.cores)},
                   {"%, 1 core"},
                   {"%, " + on_cores(run.cores)}});
  const std::vector<Occupant> rows = occupants(run);
  for (const Occupant& row : rows) {
    const auto kb = [](std::optional<Bytes> b) { return b ? kilobytes(*b) : kNothing; };
    const auto percent = [&](std::optional<Bytes> b) {
      return b ? number(percent_of_nominal(*b, row.size), 2) : kNothing;
    };
    table.add({row.name, row.memory, kb(row.single), kb(row.parallel), percent(row.single),
               percent(row.parallel)});
  }
  return fmt::format("memory (kB of 1000 bytes, % of {} kB L1 and {} kB L2)\n",
                     run.l1_size.count() / 1024, run.l2_size.count() / 1024) +
         table.str() + blocks_at_peak(rows);
}

std::string frame_summary(const RunResult& run) {
  const std::int64_t keyframes = std::count_if(run.frames.begin(), run.frames.end(),
                                               [](const FrameResult& f) { return f.keyframe; });
  const std::int64_t tracked = count_of(run, PoseSource::Tracked);
  std::string text = fmt::format(
      "frames: {} ({}EPnP {}, 8-point {}, pose kept {}, predicted {}), keyframes {}\n"
      "        per frame {:.1f} features, {:.1f} world matches, {:.1f} frame matches, "
      "{:.1f} landmarks\n",
      run.frames.size(), tracked > 0 ? fmt::format("tracked {}, ", tracked) : "",
      count_of(run, PoseSource::Epnp), count_of(run, PoseSource::EightPoint),
      count_of(run, PoseSource::Kept), count_of(run, PoseSource::Predicted), keyframes,
      mean_of(run, &FrameResult::features), mean_of(run, &FrameResult::world_matches),
      mean_of(run, &FrameResult::frame_matches), mean_of(run, &FrameResult::landmarks));
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

std::string report(const RunResult& run) {
  std::string text;
  if (run.timed)
    for (const auto table : {stage_table, breakdown_table, latency_table, camera_summary,
                             memory_table, energy_table, power_table, operating_point_table})
      if (const std::string lines = table(run); !lines.empty()) text += lines + '\n';
  return text + frame_summary(run) + trajectory_summary(run) + host_line(run);
}

}  // namespace leviosim::tools
