#include "tools/app/record/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "sim/energy/area.h"
#include "sim/work/counts.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

using traces::ErrorSummary;
using traces::Evaluation;
using traces::RelativeErrors;

void add_run(StatisticList& list, const RunResult& run) {
  list.add("run.image_width", "px", "width of the image that the workload gets", run.image_width);
  list.add("run.image_height", "px", "height of that image", run.image_height);
  list.add("run.frame_period", "ns", "time between two camera frames", run.frame_period_ns);
  if (!run.timed) return;
  list.add("run.cores", "1", "cores N of the parallel execution", run.cores);
  list.add("run.cluster_clock", "Hz", "clock of the cluster", run.cluster_clock.count());
  list.add("run.controller_clock", "Hz", "clock of the fabric controller",
           run.controller_clock.count());
  list.add("run.l1_size", "byte", "size of L1", run.l1_size.count());
  list.add("run.l2_size", "byte", "size of L2", run.l2_size.count());
}

void add_cycles(StatisticList& list, const std::string& path, const RunResult& run,
                const StageResult& stage) {
  const std::optional<double> parallel = mean(stage.parallel, stage.calls);
  const Hertz clock = clock_of(run, stage);
  list.add(path + "cycles.single.sum", "cycles", "cycles of all calls on one core",
           stage.single.count());
  list.add(path + "cycles.single.mean", "cycles", "cycles of a call on one core",
           value_of(mean(stage.single, stage.calls)));
  list.add(path + "cycles.parallel.sum", "cycles", "cycles of all calls on N cores",
           stage.parallel.count());
  list.add(path + "cycles.parallel.mean", "cycles", "cycles of a call on N cores",
           value_of(parallel));
  list.add(path + "cycles.parallel.worst", "cycles", "longest call on N cores",
           stage.worst_parallel.count());
  list.add(path + "speedup", "1", "cycles on one core over those on N cores",
           value_of(speedup(stage)));
  list.add(path + "unmeasured", "1",
           "share of the cycles on one core of code that was not measured as compiled code",
           value_of(unmeasured_share(stage)));
  list.add(path + "time.parallel.mean", "ms", "time of a call on N cores",
           parallel ? Json(milliseconds(*parallel, clock)) : Json(nullptr));
}

void add_breakdown(StatisticList& list, const std::string& path, const RunResult& run,
                   const StageResult& stage) {
  list.add(path + "breakdown.total", "core-cycles", "core-cycles of the team on N cores",
           stage.account.total());
  for (const sim::MechanismInfo& part : breakdown_parts(run))
    list.add(fmt::format("{}breakdown.{}", path, part.key), "core-cycles", part.meaning,
             stage.account.team[part.mechanism]);
}

/// Those that the chip has, whether or not they serve anything.
void add_accelerators(StatisticList& list, const RunResult& run) {
  for (const auto& [where, units] : {std::pair("cluster", &run.chip.cluster.accelerators),
                                     std::pair("controller", &run.chip.controller.accelerators)})
    for (const work::OffloadKindInfo& info : work::kOffloadKinds)
      if (const int count = (*units)[work::index(info.kernel)].units; count > 0)
        list.add(fmt::format("accelerators.{}.{}.units", where, info.name), "1",
                 fmt::format("units of the {}: {}", where, info.description), count);
}

/// Of chips with accelerators only.
void add_served(StatisticList& list, const std::string& path, const StageResult& stage) {
  for (const work::OffloadWork& calls : stage.served) {
    const work::OffloadKindInfo& info = work::kOffloadKinds[work::index(calls.kernel)];
    const std::string kernel = fmt::format("{}served.{}.", path, info.name);
    list.add(kernel + "calls", "1",
             fmt::format("calls that an accelerator served: {}", info.description), calls.calls);
    list.add(kernel + "items", "1", fmt::format("items of these calls, each a {}", info.item),
             calls.items);
  }
}

void add_blocks(StatisticList& list, const std::string& path,
                const std::vector<work::Block>& blocks) {
  for (const BlockGroup& group : grouped(blocks))
    list.add(fmt::format("{}block.{}", path, key_of(group.name)), "byte",
             fmt::format("block \"{}\" alive at the peak, {} of them", group.name, group.copies),
             group.bytes.count());
}

/// Where code is reused tells which caches hold it.
void add_code(StatisticList& list, const std::string& path, const StageResult& stage) {
  for (std::size_t k = 0; k < work::kReuseDistances.size(); ++k)
    if (stage.counts.code[k] > 0)
      list.add(fmt::format("{}code.reuse_{}", path, work::kReuseDistances[k]), "byte",
               "code fetched again at a reuse distance of about so many bytes",
               stage.counts.code[k]);
  list.add(path + "code.first", "byte", "code fetched for the first time, or after 64 KiB of other",
           stage.counts.code[work::kNeverFetched]);
}

void add_stage(StatisticList& list, const RunResult& run, const StageResult& stage) {
  const std::string path = fmt::format("stages.{}.", key_of(stage.name));
  list.add(path + "calls", "1", fmt::format("executions, one per {}", stage.unit), stage.calls);
  add_cycles(list, path, run, stage);
  add_breakdown(list, path, run, stage);
  add_served(list, path, stage);
  for (const work::OpInfo& op : work::op_list())
    list.add(fmt::format("{}ops.{}", path, op.name), "1", op.description, stage.counts[op.op]);
  add_code(list, path, stage);
  list.add(path + "memory.single", "byte", "peak in its memory on one core",
           stage.memory.single.count());
  list.add(path + "memory.parallel", "byte", "peak in its memory on N cores",
           stage.memory.parallel.count());
  add_blocks(list, path + "memory.", stage.memory.blocks);
  if (stage.transfers.tiles == 0) return;
  list.add(path + "tiles", "1", "tiles that passed through its memory", stage.transfers.tiles);
  list.add(path + "tile_bytes", "byte", "size of these tiles together",
           stage.transfers.tile_bytes.count());
  list.add(path + "tile_bytes_more", "byte", "of these, what would not move with more memory",
           stage.transfers.tile_bytes_more.count());
}

void add_frames(StatisticList& list, const RunResult& run) {
  list.add("frames.count", "1", "frames processed", run.frames.size());
  const auto count = [&](const auto& condition) {
    return std::count_if(run.frames.begin(), run.frames.end(), condition);
  };
  for (const vio::PoseSourceInfo& info : vio::kPoseSources)
    list.add(fmt::format("frames.source.{}", info.name), "1", "frames by source of the pose",
             count([&](const FrameResult& f) { return f.source == info.source; }));
  list.add("frames.keyframes", "1", "frames that became keyframes",
           count([](const FrameResult& f) { return f.keyframe; }));
  for (std::size_t h = 0; h < vio::kHealthNames.size(); ++h)
    list.add(fmt::format("frames.health.{}", vio::kHealthNames[h]), "1",
             "frames by what the estimator knows of its map",
             count([&](const FrameResult& f) { return f.health == static_cast<int>(h); }));
  for (const vio::FrameFact& fact : vio::kFrameFacts) {
    if (!fact.adds_up) continue;
    std::int64_t sum = 0;
    for (const FrameResult& frame : run.frames) sum += frame.*fact.of;
    list.add(fmt::format("frames.{}.sum", fact.name), "1", "sum over the frames", sum);
  }
}

void add_latencies(StatisticList& list, const RunResult& run) {
  const Waiting waiting = frames_that_waited(run);
  list.add("frames.waited", "1", "frames that found the front end busy", waiting.frames);
  list.add("frames.longest_wait", "ns", "longest wait of a frame for the front end",
           waiting.longest_ns);
  for (const Scenario& scenario : scenarios(run)) {
    const std::string path = fmt::format("latency.{}.", scenario.key);
    list.add(path + "frames", "1", fmt::format("frames of the kind \"{}\"", scenario.name),
             scenario.frames);
    list.add(path + "mean", "ns", "time from the camera's frame to its pose",
             value_of(scenario.mean_latency_ns()));
    list.add(path + "worst", "ns", "longest time from the camera's frame to its pose",
             scenario.worst_latency_ns);
    list.add(path + "over_period", "1", "frames whose latency exceeds the frame period",
             scenario.over_period);
    list.add(path + "cycles.single.mean", "cycles", "cycles of the front end on one core",
             value_of(mean(scenario.single, scenario.frames)));
    list.add(path + "cycles.parallel.mean", "cycles", "cycles of the front end on N cores",
             value_of(mean(scenario.parallel, scenario.frames)));
  }
}

/// Of all frames together.
void add_frame_figures(StatisticList& list, const RunResult& run) {
  std::int64_t latency_sum_ns = 0;
  Cycles single, parallel;
  for (const FrameResult& frame : run.frames) {
    latency_sum_ns += frame.end_ns - frame.arrival_ns;
    single += frame.single_cycles;
    parallel += frame.cycles;
  }
  const CameraFigures::Latencies latency = latencies_of(run);
  const std::int64_t frames = std::ssize(run.frames);
  const auto add = [&](const char* name, const char* description, Json ns) {
    list.add(fmt::format("frame.latency.{}", name), "ns", description,
             frames == 0 ? Json() : std::move(ns));
  };
  add("mean", "time from the camera's frame to its pose, all frames",
      static_cast<double>(latency_sum_ns) / static_cast<double>(frames));
  add("p50", "median time from the camera's frame to its pose", latency.p50_ns);
  add("p95", "latency that 95 % of the processed frames do not exceed", latency.p95_ns);
  add("p99", "latency that 99 % of the processed frames do not exceed", latency.p99_ns);
  add("worst", "longest time from the camera's frame to its pose", latency.max_ns);
  list.add("frame.cycles.single.mean", "cycles", "cycles of the front end on one core",
           value_of(mean(single, frames)));
  list.add("frame.cycles.parallel.mean", "cycles", "cycles of the front end on N cores",
           value_of(mean(parallel, frames)));
}

/// Without a camera in simulated time, the queue of a slow chip only says how long the flight is;
/// there a frame is late by its own time.
void add_missed_share(StatisticList& list, const RunResult& run) {
  if (expected_poses(run) == 0) return;
  const std::optional<CameraFigures> camera = camera_figures(run);
  const std::optional<FrameTimes> times = frame_times(run);
  const double share =
      camera ? camera->share_of(camera->missed())
             : static_cast<double>(times->late) / static_cast<double>(run.frames.size());
  list.add("frame.missed_share", "1", "frames without a pose within a period of the camera", share);
}

/// Bands are there where they were asked for.
void add_frame_times(StatisticList& list, const RunResult& run) {
  const std::optional<FrameTimes> times = frame_times(run);
  if (!times) return;
  const auto add = [&](const std::string& name, const char* description, const Banded& ns) {
    list.add(name, "ns", description, rounded(ns.value));
    if (!times->has_bands) return;
    list.add(name + ".low", "ns", fmt::format("{}: low end", description), rounded(ns.low));
    list.add(name + ".high", "ns", fmt::format("{}: high end", description), rounded(ns.high));
  };
  add("frame.time.mean", "time that a frame takes by itself, without waiting for others",
      times->mean_ns);
  add("frame.time.p99", "time that 99 % of the frames do not exceed by themselves", times->p99_ns);
  add("frame.time.worst", "longest time that a frame takes by itself", times->worst_ns);
}

void add_figure_rows(StatisticList& list, const RunResult& run) {
  for (const FigureRow& row : figure_rows())
    if (const auto value = row.of ? row.of(run) : std::nullopt)
      list.add(std::string(row.statistic), row.unit, row.meaning, rounded(*value));
}

void add_stage_bands(StatisticList& list, const RunResult& run) {
  if (!run.time_bands) return;
  for (const TimeBands::Stage& stage : run.time_bands->stages) {
    const std::string path = fmt::format("stages.{}.cycles.parallel.band.", key_of(stage.stage));
    list.add(path + "low", "1", "ratio of the mean on N cores to its value: low end",
             rounded(stage.parallel.low));
    list.add(path + "high", "1", "ratio of the mean on N cores to its value: high end",
             rounded(stage.parallel.high));
  }
}

/// Of closed loops only.
void add_camera(StatisticList& list, const RunResult& run) {
  const std::optional<CameraFigures> figures = camera_figures(run);
  if (!figures) return;
  list.add("camera.rate", "1/s", "frames that the camera delivers", run.camera->fps);
  list.add("camera.arrived", "1", "frames that the camera delivered", figures->arrived);
  list.add("camera.processed", "1", "frames of the camera that the front end took",
           figures->processed);
  list.add("camera.dropped", "1", "frames of the camera that were lost", figures->dropped);
  list.add("camera.late", "1", "processed frames whose latency exceeds the frame period",
           figures->late);
  list.add("camera.missed", "1", "frames that were dropped or late", figures->missed());
  list.add("camera.dropped_share", "1", "dropped frames over arrived ones",
           figures->share_of(figures->dropped));
  list.add("camera.most_found", "1", "most frames that one found in the camera's two buffers",
           figures->most_found);
}

void add_l2(StatisticList& list, const RunResult& run) {
  for (const L2Row& row : run.l2) {
    const std::string path = fmt::format("memory.l2.{}.", key_of(row.name));
    list.add(path + "bytes", "byte", "occupation of L2", row.bytes.count());
    add_blocks(list, path, row.blocks);
  }
}

void add_external(StatisticList& list, const RunResult& run) {
  for (const L2Row& row : run.external) {
    list.add("memory.external.bytes", "byte", "occupation of external memory", row.bytes.count());
    add_blocks(list, "memory.external.", row.blocks);
  }
}

/// A figure and the ends of its band.
template <class T>
void add_banded(StatisticList& list, const std::string& name, std::string_view unit,
                std::string_view description, const std::optional<sim::Estimate<T>>& figure,
                double scale) {
  const auto value = [&](auto of) { return figure ? Json(of(*figure).count() * scale) : Json(); };
  using E = sim::Estimate<T>;
  list.add(name, unit, description, value([](const E& e) { return e.value; }));
  list.add(name + ".low", unit, fmt::format("{}: low end", description),
           value([](const E& e) { return e.low(); }));
  list.add(name + ".high", unit, fmt::format("{}: high end", description),
           value([](const E& e) { return e.high(); }));
}

void add_energy_row(StatisticList& list, const EnergyRow& row,
                    std::span<const sim::DomainInfo> domains) {
  const std::string path = fmt::format("energy.{}.", key_of(row.name));
  add_banded(list, path + "call", "uJ", fmt::format("energy per {}", row.unit), row.per_call(),
             1e6);
  add_banded(list, path + "power", "mW", "mean power while it runs", row.power(), 1e3);
  for (const sim::DomainInfo& info : domains)
    add_banded(list, fmt::format("{}domain.{}", path, info.name), "mJ", info.description,
               std::optional(row.energy[info.domain]), 1e3);
}

void add_energy(StatisticList& list, const RunResult& run) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return;
  list.add("run.voltage", "V", "supply of the chip", run.chip.supply.voltage.count());
  const auto domains = sim::domains_of(energy->total());
  for (const EnergyRow& row : energy->rows) add_energy_row(list, row, domains);
  add_banded(list, "energy.total", "mJ", "energy of the whole run",
             std::optional(energy->total().total()), 1e3);
  add_banded(list, "energy.frame", "mJ", "energy per frame, idle time included",
             energy->per_frame(), 1e3);
  add_banded(list, "energy.mean_power", "mW", "mean power over the whole run", energy->mean_power(),
             1e3);
  add_banded(list, "energy.front_end_power", "mW", "power while the cluster works",
             energy->power_of_front_end(), 1e3);
  add_banded(list, "energy.controller_power", "mW", "power that the controller adds while it works",
             energy->power_of_controller(), 1e3);
}

/// Of chips with areas. Missing, not too small, where a part's area is unknown.
void add_area(StatisticList& list, const RunResult& run) {
  if (!sim::knows_area(run.chip)) return;
  const auto add = [&](const std::string& name, const char* description, const sim::AreaItem& sum) {
    const auto mm2 = [&](sim::SquareMicrometres area) {
      return sum.known ? Json(area.count() * 1e-6) : Json();
    };
    list.add(name, "mm2", description, mm2(sum.area));
    list.add(name + ".low", "mm2", fmt::format("{}: low end", description), mm2(sum.low));
    list.add(name + ".high", "mm2", fmt::format("{}: high end", description), mm2(sum.high));
  };
  add("area.chip", "logic and memories of the chip", sim::total_area(run.chip));
  add("area.cluster", "area of the cluster", sim::cluster_area(run.chip));
}

void add_accuracy(StatisticList& list, const RunResult& run) {
  if (!has_poses(run)) return;
  list.add("trajectory.poses", "1", "poses of the trajectory", run.trajectory.size());
  list.add("trajectory.length", "m", "length of the estimated path",
           rounded(path_length(run.trajectory)));
  if (run.ate) add_ate(list, *run.ate);
}

StatisticList list_of(const RunResult& run) {
  StatisticList list;
  add_run(list, run);
  if (run.timed) add_accelerators(list, run);
  if (run.timed)
    for (const StageResult& stage : run.stages) add_stage(list, run, stage);
  add_frames(list, run);
  if (run.timed) add_frame_times(list, run);
  add_figure_rows(list, run);
  if (run.timed) {
    add_stage_bands(list, run);
    add_latencies(list, run);
    add_camera(list, run);
    add_frame_figures(list, run);
    add_missed_share(list, run);
    add_l2(list, run);
    add_external(list, run);
    add_energy(list, run);
    add_area(list, run);
    list.add("optimiser.published", "1", "results that reached the front end",
             run.optimiser_published);
    list.add("optimiser.late", "1", "frames at whose start the controller was still busy",
             run.optimiser_late);
  }
  add_accuracy(list, run);
  return list;
}

}  // namespace

RunFigures figures_of(const RunResult& run) {
  RunFigures figures;
  if (run.timed)
    for (const StageResult& stage : run.stages)
      figures.stages.push_back({stage.name, key_of(stage.name), stage.on_controller});
  figures.statistics = list_of(run).take();
  complete(figures, recorded_frames(run));
  return figures;
}

void add_ate(StatisticList& list, const Evaluation& evaluation,
             const std::optional<traces::AttitudeErrors>& attitude) {
  const auto add = [&](const char* name, const char* unit, const char* description, Json value) {
    list.add(std::string("accuracy.") + name, unit, description, std::move(value),
             evaluation.protocol);
  };
  const ErrorSummary& t = evaluation.translation;
  add("ate.rmse", "m", "absolute trajectory error, root mean square", rounded(t.rmse));
  add("ate.mean", "m", "absolute trajectory error, mean", rounded(t.mean));
  add("ate.median", "m", "absolute trajectory error, median", rounded(t.median));
  add("ate.worst", "m", "absolute trajectory error, worst", rounded(t.max));
  if (evaluation.located_rmse_m)
    add("ate.located", "m", "absolute trajectory error without poses that are guesses, RMS",
        rounded(*evaluation.located_rmse_m));
  if (attitude) {
    add("tilt.rmse", "deg", "error of the vertical, attitudes best aligned, root mean square",
        rounded(attitude->tilt_rmse_deg));
    add("heading.rmse", "deg", "error about the vertical, attitudes best aligned, root mean square",
        rounded(attitude->heading_rmse_deg));
  }
  add("matched", "1", "poses matched with the ground truth", evaluation.matched);
  add("completion", "1", "share of the flight that has an estimate",
      rounded(evaluation.completion));
  add("truth_length", "m", "length of the true path", rounded(evaluation.path_length_m));
  add("size_ratio", "1",
      "scale: RMS distance of the estimated positions from their mean, over that of the true ones",
      evaluation.size_ratio ? rounded(*evaluation.size_ratio) : Json());
}

std::string relative_protocol(const Evaluation& evaluation) {
  return "from every matched pose to the first that is the length farther along the true path; " +
         evaluation.protocol;
}

void add_relative(StatisticList& list, const Evaluation& evaluation, const RelativeErrors& errors) {
  const std::string path = fmt::format("accuracy.relative.{:g}m.", errors.length_m);
  const std::string protocol = relative_protocol(evaluation);
  list.add(path + "count", "1", "sub-trajectories of this length", errors.count, protocol);
  const auto add = [&](const std::string& kind, const char* unit, const ErrorSummary& summary) {
    struct Figure {
      const char* name;
      const char* description;
      double value;
    };
    for (const Figure& f :
         {Figure{"rmse", "root mean square", summary.rmse}, Figure{"mean", "mean", summary.mean},
          Figure{"median", "median", summary.median}, Figure{"worst", "worst", summary.max}})
      list.add(path + kind + '.' + f.name, unit, "relative " + kind + " error, " + f.description,
               errors.count > 0 ? rounded(f.value) : Json(nullptr), protocol);
  };
  add("translation", "%", errors.translation);
  add("rotation", "deg/m", errors.rotation_deg_per_m);
}

}  // namespace leviosim::tools
