#include "tools/app/run/run_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "sim/work/op.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {
namespace {

Columns<StageResult> stage_table_of(const RunResult& run) {
  using S = StageResult;
  Columns<S> table{
      {{.key = "stage"}, [](const S& s) { return s.name; }},
      {{.key = "call"}, [](const S& s) { return s.unit; }},
      {{.key = "runs_on"}, [](const S& s) { return s.on_controller ? "controller" : "cluster"; }},
      {{.key = "calls"}, [](const S& s) { return s.calls; }},
      {{.key = "single_cycles"}, [](const S& s) { return s.single; }},
      {{.key = "parallel_cycles"}, [](const S& s) { return s.parallel; }},
      {{.key = "single_cycles_per_call", .decimals = 3},
       [](const S& s) { return mean(s.single, s.calls); }},
      {{.key = "parallel_cycles_per_call", .decimals = 3},
       [](const S& s) { return mean(s.parallel, s.calls); }},
      {{.key = "worst_parallel_cycles"}, [](const S& s) { return s.worst_parallel; }},
      {{.key = "speedup", .decimals = 3}, [](const S& s) { return speedup(s); }},
      {{.key = "parallel_ms_per_call", .decimals = 3},
       [&run](const S& s) {
         const std::optional<double> cycles = mean(s.parallel, s.calls);
         return cycles ? Cell(milliseconds(*cycles, clock_of(run, s))) : Cell();
       }},
      {{.key = "memory_single_bytes"}, [](const S& s) { return s.memory.single; }},
      {{.key = "memory_parallel_bytes"}, [](const S& s) { return s.memory.parallel; }},
  };
  for (const sim::MechanismInfo& part : breakdown_parts(run))
    table.push_back({{.key = fmt::format("{}_core_cycles", part.key), .decimals = 3},
                     [part](const S& s) { return s.account.team[part.mechanism]; }});
  for (const sim::MechanismInfo& part : breakdown_parts(run))
    table.push_back({{.key = fmt::format("single_{}_cycles", part.key), .decimals = 3},
                     [part](const S& s) { return s.single_account[part.mechanism]; }});
  for (const work::OpInfo& op : work::kOps)
    table.push_back(
        {{.key = fmt::format("{}_ops", op.name)}, [&op](const S& s) { return s.counts[op.op]; }});
  return table;
}

/// A frame of the camera; one that was dropped has no result.
struct FrameRow {
  const FrameResult* result = nullptr;
  const soc::Delivery* delivery = nullptr;  ///< of a closed loop
  bool missed = false;
};

/// A column about what came of the frame: empty for one that was dropped.
template <class Of>
Column<FrameRow> of_result(std::string key, Of of) {
  return {{.key = std::move(key)}, [of](const FrameRow& row) {
            return row.result == nullptr ? Cell() : Cell(of(*row.result));
          }};
}

/// Of a stage among those of frames.
std::size_t number_of(const std::string& stage, const RunResult& run) {
  return static_cast<std::size_t>(
      std::find(run.frame_stages.begin(), run.frame_stages.end(), stage) -
      run.frame_stages.begin());
}

Columns<FrameRow> frame_table_of(const RunResult& run) {
  using F = FrameResult;
  Columns<FrameRow> table;
  table.push_back({{.key = "frame"}, [](const FrameRow& r) {
                     return r.result ? r.result->index : r.delivery->frame;
                   }});
  table.push_back({{.key = "t_ns"},
                   [](const FrameRow& r) { return r.result ? r.result->t_ns : r.delivery->t_ns; }});
  table.push_back(of_result("source", [](const F& f) { return name_of(f.source); }));
  table.push_back(of_result("keyframe", [](const F& f) { return int{f.keyframe}; }));
  for (const vio::FrameFact& fact : vio::kFrameFacts)
    table.push_back(of_result(std::string(fact.name), [&fact](const F& f) {
      const auto value = static_cast<std::size_t>(f.*fact.of);
      return value < fact.words.size() ? Cell(fact.words[value]) : Cell(f.*fact.of);
    }));
  if (run.timed) {
    table.push_back({{.key = "arrival_ns"}, [](const FrameRow& r) {
                       return r.result ? r.result->arrival_ns : r.delivery->arrival_ns;
                     }});
    table.push_back(of_result("start_ns", [](const F& f) { return f.start_ns; }));
    table.push_back(of_result("end_ns", [](const F& f) { return f.end_ns; }));
    table.push_back(of_result("latency_ns", [](const F& f) { return f.end_ns - f.arrival_ns; }));
    table.push_back(of_result("parallel_cycles", [](const F& f) { return f.cycles; }));
    table.push_back(of_result("single_cycles", [](const F& f) { return f.single_cycles; }));
    for (const StageResult& stage : run.stages)
      if (!stage.on_controller)
        table.push_back(of_result(
            kStageColumn + key_of(stage.name), [i = number_of(stage.name, run)](const F& f) {
              return i < f.stage_cycles.size() ? f.stage_cycles[i] : Cycles(0);
            }));
  }
  if (run.camera) {
    table.push_back(
        {{.key = "found_in_buffers"}, [](const FrameRow& r) { return r.delivery->found; }});
    table.push_back(
        {{.key = "dropped"}, [](const FrameRow& r) { return int{r.delivery->dropped}; }});
    table.push_back({{.key = "missed"}, [](const FrameRow& r) { return int{r.missed}; }});
  }
  return table;
}

/// All frames; in a closed loop those of the camera, dropped or not.
void each_frame_of_camera(const RunResult& run, const std::function<void(const FrameRow&)>& take) {
  if (!run.camera) {
    for (const FrameResult& frame : run.frames) take({&frame, nullptr, false});
    return;
  }
  auto frame = run.frames.begin();
  for (const soc::Delivery& delivery : run.camera->deliveries) {
    if (delivery.dropped)
      take({nullptr, &delivery, true});
    else {
      take({&*frame, &delivery, is_late(*frame, run)});
      ++frame;
    }
  }
}

/// A peak of a memory, or a block that was alive at it.
struct MemoryRow {
  std::string_view memory;
  Bytes size;  ///< of the memory
  std::string_view owner;
  std::string_view what;
  std::string_view block;
  int copies;
  Bytes bytes;
};

const Columns<MemoryRow>& memory_table() {
  using M = MemoryRow;
  static const Columns<M> table{
      {{.key = "memory"}, [](const M& m) { return m.memory; }},
      {{.key = "owner"}, [](const M& m) { return m.owner; }},
      {{.key = "what"}, [](const M& m) { return m.what; }},
      {{.key = "block"}, [](const M& m) { return m.block; }},
      {{.key = "copies"}, [](const M& m) { return m.copies; }},
      {{.key = "bytes"}, [](const M& m) { return m.bytes; }},
      {{.key = "percent_of_nominal", .decimals = 3},
       [](const M& m) { return percent_of_nominal(m.bytes, m.size); }},
  };
  return table;
}

void add_peak(std::vector<MemoryRow>& rows, MemoryRow peak,
              const std::vector<work::Block>& blocks) {
  rows.push_back(peak);
  for (const BlockGroup& group : grouped(blocks))
    rows.push_back(
        {peak.memory, peak.size, peak.owner, "block", group.name, group.copies, group.bytes});
}

/// A quantity of a stage in one domain, or in total, with its band.
struct EnergyCsvRow {
  std::string stage;
  std::string quantity;
  std::string_view domain;
  sim::Estimate<Joules> energy;
  double scale;  ///< from joules to the unit
  std::string_view unit;
};

const Columns<EnergyCsvRow>& energy_table() {
  using E = EnergyCsvRow;
  static const Columns<E> table{
      {{.key = "stage"}, [](const E& e) { return e.stage; }},
      {{.key = "quantity"}, [](const E& e) { return e.quantity; }},
      {{.key = "domain"}, [](const E& e) { return e.domain; }},
      {{.key = "value", .decimals = 6},
       [](const E& e) { return e.energy.value.count() * e.scale; }},
      {{.key = "unit"}, [](const E& e) { return e.unit; }},
      {{.key = "low", .decimals = 6}, [](const E& e) { return e.energy.low().count() * e.scale; }},
      {{.key = "high", .decimals = 6},
       [](const E& e) { return e.energy.high().count() * e.scale; }},
  };
  return table;
}

void add_energy(std::vector<EnergyCsvRow>& rows, const EnergyRow& row,
                std::span<const sim::DomainInfo> domains) {
  const auto add = [&](const std::string& quantity, std::string_view unit, double scale) {
    for (const sim::DomainInfo& info : domains)
      rows.push_back({row.name, quantity, info.name, row.energy[info.domain], scale, unit});
    rows.push_back({row.name, quantity, "total", row.energy.total(), scale, unit});
  };
  add("energy", "mJ", 1e3);
  if (row.calls > 0)
    add(fmt::format("energy per {}", row.unit), "uJ", 1e6 / static_cast<double>(row.calls));
  if (row.time > Seconds(0)) add("power", "mW", 1e3 / row.time.count());
}

/// With the decimals of trajectory files.
Columns<traces::MatchedPose> error_table() {
  using P = traces::MatchedPose;
  constexpr int kDecimals = 9;
  Columns<P> table{{{.key = "t_ns"}, [](const P& p) { return p.t_ns; }},
                   {{.key = "position_error_m", .decimals = kDecimals},
                    [](const P& p) { return traces::translation_error(p); }}};
  for (const auto& [name, pose] : {std::pair{"estimate", &P::estimate}, {"truth", &P::truth}})
    for (int axis = 0; axis < 3; ++axis)
      table.push_back({{.key = fmt::format("{}_{}_m", name, "xyz"[axis]), .decimals = kDecimals},
                       [pose = pose, axis](const P& p) { return (p.*pose).translation()[axis]; }});
  return table;
}

}  // namespace

Table stage_rows(const RunResult& run) { return table_of(stage_table_of(run), run.stages); }

Table frame_rows(const RunResult& run) {
  return long_table_of<FrameRow>(frame_table_of(run),
                                 [&run](const auto& take) { each_frame_of_camera(run, take); });
}

Table memory_rows(const RunResult& run) {
  std::vector<MemoryRow> rows;
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller) continue;  // it is one of the rows of L2
    const work::MemoryPeak& peak = stage.memory;
    add_peak(rows, {"L1", run.l1_size, stage.name, "peak on one core", "", 1, peak.single}, {});
    add_peak(rows, {"L1", run.l1_size, stage.name, "peak on N cores", "", 1, peak.parallel},
             peak.blocks);
  }
  for (const L2Row& row : run.l2)
    add_peak(rows, {"L2", run.l2_size, row.name, "peak", "", 1, row.bytes}, row.blocks);
  for (const L2Row& row : run.external)
    add_peak(rows, {"external", run.external_size, row.name, "peak", "", 1, row.bytes}, row.blocks);
  return table_of(memory_table(), rows);
}

Table error_rows(const RunResult& run) {
  if (!run.ate || run.ate->poses.empty()) return Table{{}};
  return long_table_of<traces::MatchedPose>(error_table(), [&run](const auto& take) {
    for (const traces::MatchedPose& pose : run.ate->poses) take(pose);
  });
}

Table energy_rows(const RunResult& run) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return Table{{}};
  std::vector<EnergyCsvRow> rows;
  const auto domains = sim::domains_of(energy->total());
  for (const EnergyRow& row : energy->rows) add_energy(rows, row, domains);
  add_energy(rows, {"all", "frame", false, energy->frames, energy->time, energy->total()}, domains);
  return table_of(energy_table(), rows);
}

}  // namespace leviosim::tools
