#include "tools/app/study/feasibility/feasibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/interruption.h"
#include "sim/chip/accelerator.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/trace_source.h"

namespace leviosim::tools {
namespace {

/// What the work is recorded on. It only decides where scratch lies in L1.
constexpr const char* kRecordedOn = "gap9";
/// Between two frames: no chip of this class is busy for so long.
constexpr std::int64_t kLeisurelyNs = 20'000'000'000;
constexpr Bytes kUnlimited{std::int64_t{1} << 40};

/// Recorded frames of which each has all the time that it needs, in memories that hold everything.
class LeisurelySource : public TraceSource {
 public:
  LeisurelySource(const traces::WorkTrace& work, const sim::ChipConfig& chip)
      : TraceSource(work, kUnlimited, kUnlimited, sim::has_accelerators(chip)) {}

  std::int64_t arrival_ns(int frame) const override { return frame * kLeisurelyNs; }
  void describe(RunResult& result) const override {
    TraceSource::describe(result);
    result.frame_period_ns = kLeisurelyNs;
  }
};

/// The block at which blocks, one after the other, exceed the memory.
std::string first_beyond(const std::vector<work::Block>& blocks, Bytes size, Bytes& used) {
  for (const work::Block& block : blocks) {
    used += block.size;
    if (used > size) return std::string(block.name);
  }
  return {};
}

MemoryVerdict verdict_of_l1(const RunResult& run) {
  MemoryVerdict verdict{run.chip.cluster.l1.size, {}, {}};
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller || stage.memory.parallel <= verdict.occupied) continue;
    verdict.occupied = stage.memory.parallel;
    Bytes used;
    verdict.block = first_beyond(stage.memory.blocks, verdict.size, used);
  }
  return verdict;
}

MemoryVerdict verdict_of_l2(const RunResult& run) {
  MemoryVerdict verdict{run.chip.l2.size, {}, {}};
  for (const L2Row& row : run.l2) {
    Bytes used = verdict.occupied;
    verdict.occupied += row.bytes;
    if (verdict.block.empty()) verdict.block = first_beyond(row.blocks, verdict.size, used);
  }
  return verdict;
}

double ms_of(double cycles, Hertz clock) {
  return cycles * 1e3 / static_cast<double>(clock.count());
}

void add_times(const RunResult& run, Feasibility& found) {
  const auto frames = static_cast<double>(run.frames.size());
  for (const FrameResult& frame : run.frames) {
    const double ms = ms_of(static_cast<double>(frame.cycles.count()), run.cluster_clock);
    found.front_end_ms += ms / frames;
    found.worst_ms = std::max(found.worst_ms, ms);
  }
  for (const StageResult& stage : run.stages)
    if (stage.calls > 0)
      found.stages.push_back({stage.name, static_cast<double>(stage.parallel.count()) * 1e-3 /
                                              static_cast<double>(stage.calls)});
  for (const StageResult& stage : run.stages)
    if (stage.on_controller)
      found.optimiser_ms +=
          ms_of(static_cast<double>(stage.parallel.count()), run.controller_clock) / frames;
}

}  // namespace

double Feasibility::frame_ms() const {
  return shares_core ? front_end_ms + optimiser_ms : std::max(front_end_ms, optimiser_ms);
}

const traces::WorkTrace& FeasibilityStudy::work_among(int cores) {
  std::unique_ptr<traces::WorkTrace>& work = work_[cores];
  if (work) return *work;
  // What is computed does not depend on the chip; each core needs a scratch of L1.
  std::vector<std::string> overrides;
  const sim::ClusterConfig cluster = platform::load_platform(kRecordedOn).cluster;
  if (cores > cluster.max_workers)
    overrides = {
        fmt::format("cluster.max_workers={}", cores),
        fmt::format("cluster.l1.size={}", cluster.l1.size.count() * cores / cluster.max_workers)};
  RunRequest request = request_;
  request.platform = platform::resolve_platform(kRecordedOn, overrides);
  request.cores = cores;
  WorkRecording recording(cores);
  request.recording = &recording;
  simulate(request, progress_);
  work = std::make_unique<traces::WorkTrace>("recorded work",
                                             recording.writer.finish(std::move(recording.info)));
  return *work;
}

std::vector<Feasibility> FeasibilityStudy::on(const std::vector<FeasibilityPoint>& points,
                                              const RunnerOptions& options) {
  std::vector<Feasibility> rows(points.size());
  const auto may_fail = [&](std::size_t i, const auto& act) {
    if (!rows[i].failure.empty()) return;
    try {
      act(points[i]);
    } catch (const InputError& error) {
      rows[i] = {};
      rows[i].failure = error.what();
    }
    rows[i].platform = points[i].name;
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    rows[i].failure = points[i].failure;
    rows[i].platform = points[i].name;
    may_fail(i, [&](const FeasibilityPoint& point) { work_among(point.cores); });
  }
  run_all(points.size(), options, [&](std::size_t i) {
    may_fail(i, [&](const FeasibilityPoint& point) { rows[i] = on(point); });
  });
  if (std::all_of(rows.begin(), rows.end(), [](const auto& row) { return !row.failure.empty(); }))
    throw InputError(rows.front().failure);
  return rows;
}

Feasibility FeasibilityStudy::on(const FeasibilityPoint& point) {
  const traces::WorkTrace& work = work_among(point.cores);
  RunRequest request;
  request.platform = point.platform;
  request.cores = point.cores;
  check_cores(work, request);
  Feasibility found;
  found.platform = point.name;
  found.cores = point.cores;
  found.clock = point.platform.config.cluster.clock;
  found.shares_core = point.platform.config.controller.shares_core;
  LeisurelySource source(work, request.platform.config);
  const RunResult leisurely =
      simulate_source(request, source, [](const Progress&) { throw_if_interrupted(); });
  add_times(leisurely, found);
  found.l1 = verdict_of_l1(leisurely);
  found.l2 = verdict_of_l2(leisurely);
  const double period_ms =
      std::max(static_cast<double>(work.info().frame_period_ns) * 1e-6, found.frame_ms());
  const Seconds time(period_ms * 1e-3 * static_cast<double>(leisurely.frames.size()));
  if (const auto energy = energy_of(leisurely, time)) {
    found.energy_per_frame = energy->per_frame();
    found.power = energy->mean_power();
  }
  return found;
}

}  // namespace leviosim::tools
