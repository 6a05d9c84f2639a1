#include "tools/app/study/feasibility/feasibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/interruption.h"
#include "sim/chip/accelerator.h"
#include "sim/work/arena.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/trace_source.h"

namespace leviosim::tools {
namespace {

/// What the work is recorded on; its memories decide what passes in tiles.
constexpr const char* kRecordedOn = "gap9";
/// Between two frames: no chip of this class is busy for so long.
constexpr std::int64_t kLeisurelyNs = 20'000'000'000;
constexpr Bytes kUnlimited{std::int64_t{1} << 40};
/// Of L2, where what is short of it is the verdict.
constexpr Bytes kPlenty{std::int64_t{1} << 26};

/// Recorded frames of which each has all the time that it needs, in memories that hold everything.
class LeisurelySource : public TraceSource {
 public:
  LeisurelySource(const traces::WorkTrace& work, const sim::ChipConfig& chip)
      : TraceSource(work, kUnlimited, kUnlimited, sim::has_accelerators(chip)) {}

  std::int64_t arrival_ns(int frame) const override { return frame * kLeisurelyNs; }
  RunSubject subject() const override {
    RunSubject subject = TraceSource::subject();
    subject.frame_period_ns = kLeisurelyNs;
    return subject;
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

/// In memories of the chip's sizes if those of the chip on which all is recorded hold more than it
/// has. If that is impossible even so, the verdict is of the larger ones.
const FeasibilityStudy::Recorded& FeasibilityStudy::work_on(const FeasibilityPoint& point) {
  const sim::ChipConfig& chip = point.platform.config;
  const Recorded& shared = work_in({point.cores, {}, {}, {}});
  if (shared.l1 <= chip.cluster.l1.size && shared.l2 <= chip.l2.size) return shared;
  const sim::ExternalMemoryConfig& external = chip.controller.external;
  const bool has_external = external.bytes_per_second > 0 && external.size > Bytes(0);
  Memories own{point.cores, chip.cluster.l1.size, kPlenty, {}};
  if (has_external) own.l2 = chip.l2.size, own.external = external.size;
  try {
    return work_in(own);
  } catch (const work::MemoryOverflow&) {
    return shared;
  }
}

const FeasibilityStudy::Recorded& FeasibilityStudy::work_in(const Memories& memories) {
  Recorded& work = work_[memories];
  if (work.trace) return work;
  const int cores = memories.cores;
  std::vector<std::string> overrides;
  const auto set = [&](const char* path, std::int64_t value) {
    overrides.push_back(fmt::format("{}={}B", path, value));
  };
  const sim::ClusterConfig cluster = platform::load_platform(kRecordedOn).cluster;
  Bytes l1 = memories.l1.value_or(cluster.l1.size);
  if (cores > cluster.max_workers) {
    overrides.push_back(fmt::format("cluster.max_workers={}", cores));
    if (!memories.l1) l1 = Bytes(l1.count() * cores / cluster.max_workers);  // each needs a scratch
  }
  if (l1 != cluster.l1.size) set("cluster.l1.size", l1.count());
  if (memories.l2) set("l2.size", memories.l2->count());
  if (memories.external) set("controller.external.size", memories.external->count());
  RunRequest request = request_;
  request.platform = platform::resolve_platform(kRecordedOn, overrides);
  request.cores = cores;
  WorkRecording recording(cores);
  request.recording = &recording;
  const RunResult run = simulate(request, progress_);
  work.trace = std::make_unique<traces::WorkTrace>(
      "recorded work", recording.writer.finish(std::move(recording.info)));
  work.l1 = verdict_of_l1(run).occupied;
  work.l2 = verdict_of_l2(run).occupied;
  work.in_tiles = std::any_of(run.stages.begin(), run.stages.end(), [](const StageResult& stage) {
    return !stage.on_controller && stage.transfers.tiles > 0;
  });
  return work;
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
    may_fail(i, [&](const FeasibilityPoint& point) { work_on(point); });
  }
  run_all(points.size(), options, [&](std::size_t i) {
    may_fail(i, [&](const FeasibilityPoint& point) { rows[i] = on(point); });
  });
  if (std::all_of(rows.begin(), rows.end(), [](const auto& row) { return !row.failure.empty(); }))
    throw InputError(rows.front().failure);
  return rows;
}

Feasibility FeasibilityStudy::on(const FeasibilityPoint& point) {
  const Recorded& recorded = work_on(point);
  const traces::WorkTrace& work = *recorded.trace;
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
  found.in_tiles = recorded.in_tiles;
  for (const L2Row& row : leisurely.external) found.external += row.bytes;
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
