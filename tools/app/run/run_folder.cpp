#include "tools/app/run/run_folder.h"

#include <fmt/format.h>

#include "sim/base/csv.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/sha256.h"
#include "sim/work/op.h"
#include "tools/app/cli/version.h"
#include "tools/app/result/summary.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {
namespace {

using base::Cell;
using base::CsvTable;
using base::fixed;

CsvTable<StageResult> stage_table_of(const RunResult& run) {
  using S = StageResult;
  CsvTable<S> table{
      {"stage", [](const S& s) { return s.name; }},
      {"call", [](const S& s) { return s.unit; }},
      {"runs_on", [](const S& s) { return s.on_controller ? "controller" : "cluster"; }},
      {"calls", [](const S& s) { return s.calls; }},
      {"single_cycles", [](const S& s) { return s.single; }},
      {"parallel_cycles", [](const S& s) { return s.parallel; }},
      {"single_cycles_per_call", [](const S& s) { return fixed(mean(s.single, s.calls), 3); }},
      {"parallel_cycles_per_call", [](const S& s) { return fixed(mean(s.parallel, s.calls), 3); }},
      {"worst_parallel_cycles", [](const S& s) { return s.worst_parallel; }},
      {"speedup", [](const S& s) { return fixed(speedup(s), 3); }},
      {"parallel_ms_per_call",
       [&run](const S& s) {
         const std::optional<double> cycles = mean(s.parallel, s.calls);
         return cycles ? fixed(milliseconds(*cycles, clock_of(run, s)), 3) : Cell();
       }},
      {"memory_single_bytes", [](const S& s) { return s.memory.single; }},
      {"memory_parallel_bytes", [](const S& s) { return s.memory.parallel; }},
  };
  for (const sim::MechanismInfo& part : breakdown_parts(run))
    table.add(fmt::format("{}_core_cycles", part.key),
              [part](const S& s) { return fixed(s.account.team[part.mechanism], 3); });
  for (const sim::MechanismInfo& part : breakdown_parts(run))
    table.add(fmt::format("single_{}_cycles", part.key),
              [part](const S& s) { return fixed(s.single_account[part.mechanism], 3); });
  for (const work::OpInfo& op : work::kOps)
    table.add(fmt::format("{}_ops", op.name), [&op](const S& s) { return s.counts[op.op]; });
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
base::Column<FrameRow> of_result(std::string name, Of of) {
  return {std::move(name), [of](const FrameRow& row) {
            return row.result == nullptr ? Cell() : Cell(of(*row.result));
          }};
}

CsvTable<FrameRow> frame_table_of(const RunResult& run) {
  using F = FrameResult;
  CsvTable<FrameRow> table;
  const auto add = [&](base::Column<FrameRow> c) { table.add(std::move(c.name), std::move(c.of)); };
  table.add("frame",
            [](const FrameRow& r) { return r.result ? r.result->index : r.delivery->frame; });
  table.add("t_ns", [](const FrameRow& r) { return r.result ? r.result->t_ns : r.delivery->t_ns; });
  add(of_result("source", [](const F& f) { return name_of(f.source); }));
  add(of_result("keyframe", [](const F& f) { return int{f.keyframe}; }));
  for (const vio::FrameFact& fact : vio::kFrameFacts)
    add(of_result(std::string(fact.name), [&fact](const F& f) {
      const auto value = static_cast<std::size_t>(f.*fact.of);
      return value < fact.words.size() ? Cell(fact.words[value]) : Cell(f.*fact.of);
    }));
  if (run.timed) {
    table.add("arrival_ns", [](const FrameRow& r) {
      return r.result ? r.result->arrival_ns : r.delivery->arrival_ns;
    });
    add(of_result("start_ns", [](const F& f) { return f.start_ns; }));
    add(of_result("end_ns", [](const F& f) { return f.end_ns; }));
    add(of_result("latency_ns", [](const F& f) { return f.end_ns - f.arrival_ns; }));
    add(of_result("parallel_cycles", [](const F& f) { return f.cycles; }));
    add(of_result("single_cycles", [](const F& f) { return f.single_cycles; }));
    for (const StageResult& stage : run.stages)
      if (!stage.on_controller)
        add(of_result(kStageColumn + key_of(stage.name),
                      [name = stage.name](const F& f) { return f.cycles_of(name); }));
  }
  if (run.camera) {
    table.add("found_in_buffers", [](const FrameRow& r) { return r.delivery->found; });
    table.add("dropped", [](const FrameRow& r) { return int{r.delivery->dropped}; });
    table.add("missed", [](const FrameRow& r) { return int{r.missed}; });
  }
  return table;
}

/// All frames; in a closed loop those of the camera, dropped or not.
std::vector<FrameRow> frame_rows(const RunResult& run) {
  std::vector<FrameRow> rows;
  if (!run.camera) {
    for (const FrameResult& frame : run.frames) rows.push_back({&frame, nullptr, false});
    return rows;
  }
  auto frame = run.frames.begin();
  for (const soc::Delivery& delivery : run.camera->deliveries) {
    if (delivery.dropped)
      rows.push_back({nullptr, &delivery, true});
    else {
      rows.push_back({&*frame, &delivery, is_late(*frame, run)});
      ++frame;
    }
  }
  return rows;
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

const CsvTable<MemoryRow>& memory_table() {
  using M = MemoryRow;
  static const CsvTable<M> table{
      {"memory", [](const M& m) { return m.memory; }},
      {"owner", [](const M& m) { return m.owner; }},
      {"what", [](const M& m) { return m.what; }},
      {"block", [](const M& m) { return m.block; }},
      {"copies", [](const M& m) { return m.copies; }},
      {"bytes", [](const M& m) { return m.bytes; }},
      {"percent_of_nominal",
       [](const M& m) { return fixed(percent_of_nominal(m.bytes, m.size), 3); }},
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

const CsvTable<EnergyCsvRow>& energy_table() {
  using E = EnergyCsvRow;
  static const CsvTable<E> table{
      {"stage", [](const E& e) { return e.stage; }},
      {"quantity", [](const E& e) { return e.quantity; }},
      {"domain", [](const E& e) { return e.domain; }},
      {"value", [](const E& e) { return fixed(e.energy.value.count() * e.scale, 6); }},
      {"unit", [](const E& e) { return e.unit; }},
      {"low", [](const E& e) { return fixed(e.energy.low().count() * e.scale, 6); }},
      {"high", [](const E& e) { return fixed(e.energy.high().count() * e.scale, 6); }},
  };
  return table;
}

void add_energy(std::vector<EnergyCsvRow>& rows, const EnergyRow& row) {
  const auto add = [&](const std::string& quantity, std::string_view unit, double scale) {
    for (const sim::DomainInfo& info : sim::kDomains)
      rows.push_back({row.name, quantity, info.name, row.energy[info.domain], scale, unit});
    rows.push_back({row.name, quantity, "total", row.energy.total(), scale, unit});
  };
  add("energy", "mJ", 1e3);
  if (row.calls > 0)
    add(fmt::format("energy per {}", row.unit), "uJ", 1e6 / static_cast<double>(row.calls));
  if (row.time > Seconds(0)) add("power", "mW", 1e3 / row.time.count());
}

/// With the decimals of trajectory files.
CsvTable<traces::MatchedPose> error_table() {
  using P = traces::MatchedPose;
  constexpr int kDecimals = 9;
  CsvTable<P> table{{"t_ns", [](const P& p) { return p.t_ns; }},
                    {"position_error_m",
                     [](const P& p) { return fixed(traces::translation_error(p), kDecimals); }}};
  for (const auto& [name, pose] : {std::pair{"estimate", &P::estimate}, {"truth", &P::truth}})
    for (int axis = 0; axis < 3; ++axis)
      table.add(fmt::format("{}_{}_m", name, "xyz"[axis]), [pose = pose, axis](const P& p) {
        return fixed((p.*pose).translation()[axis], kDecimals);
      });
  return table;
}

Json inputs_json(const std::vector<InputDigest>& inputs) {
  Json list = Json::array();
  for (const InputDigest& input : inputs) {
    Json& entry = list.emplace_back(Json::object());
    entry["name"] = input.name;
    entry["bytes"] = input.bytes;
    entry["sha256"] = input.sha256;
  }
  return list;
}

Json platform_json(const Manifest& manifest, const RunResult& run) {
  if (!run.timed) return nullptr;
  Json platform;
  platform["name"] = manifest.platform;
  platform["overrides"] = manifest.overrides;
  platform["cores"] = run.cores;
  return platform;
}

namespace fs = std::filesystem;

InputDigest digest_of(std::string name, const std::vector<fs::path>& files, base::InputKind kind) {
  InputDigest digest;
  digest.name = std::move(name);
  base::Sha256 sha;
  for (const fs::path& file : files) {
    throw_if_interrupted();
    const std::string bytes = base::read_file(file, kind);
    sha.add(bytes);
    digest.bytes += static_cast<std::int64_t>(bytes.size());
  }
  digest.sha256 = sha.hex();
  return digest;
}

}  // namespace

std::string stages_csv(const RunResult& run) { return stage_table_of(run).text(run.stages); }

std::string frames_csv(const RunResult& run) { return frame_table_of(run).text(frame_rows(run)); }

std::string memory_csv(const RunResult& run) {
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
  return memory_table().text(rows);
}

std::string errors_csv(const RunResult& run) {
  if (!run.ate || run.ate->poses.empty()) return {};
  return error_table().text(run.ate->poses);
}

std::string energy_csv(const RunResult& run) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return {};
  std::vector<EnergyCsvRow> rows;
  for (const EnergyRow& row : energy->rows) add_energy(rows, row);
  add_energy(rows, {"all", "frame", false, energy->frames, energy->time, energy->total()});
  return energy_table().text(rows);
}

RunFiles run_files(const RunResult& run, const Manifest& manifest,
                   const std::string& platform_yaml) {
  RunFiles files{{"manifest.json", json_text(manifest_json(manifest, run), 2) + '\n'},
                 {"stats.json", statistics_text(run)},
                 {kFramesFile, frames_csv(run)},
                 {"trajectory.tum", traces::format_tum(run.trajectory)}};
  if (std::string errors = errors_csv(run); !errors.empty()) files[kErrorsFile] = std::move(errors);
  if (!run.timed) return files;
  files["platform.yaml"] = platform_yaml;
  files[kStagesFile] = stages_csv(run);
  files[kMemoryFile] = memory_csv(run);
  if (std::string energy = energy_csv(run); !energy.empty()) files[kEnergyFile] = std::move(energy);
  return files;
}

void write_run_files(outputs::OutputFolder& out, const RunFiles& files, const std::string& below) {
  for (const auto& [name, text] : files) out.write(below + name, text);
}

void write_run_folder(outputs::OutputFolder& out, const RunResult& run, const Manifest& manifest,
                      const std::string& platform_yaml, const std::string& below) {
  write_run_files(out, run_files(run, manifest, platform_yaml), below);
}

Json manifest_json(const Manifest& manifest, const RunResult& run) {
  Json document;
  document["format"] = "leviosim manifest";
  document["version"] = kManifestVersion;
  document["program"]["version"] = version();
  document["program"]["revision"] = revision();
  document["command_line"] = manifest.command_line;
  document["profile"] = run.profile;
  if (!manifest.workload.empty()) document["workload"] = manifest.workload;
  document["seed"] = manifest.seed;
  document["platform"] = platform_json(manifest, run);
  if (run.camera)
    document["camera"] = {{"frames_per_second", run.camera->fps},
                          {"deadline", info_of(run.camera->deadline).name}};
  document["image"]["width"] = run.image_width;
  document["image"]["height"] = run.image_height;
  document["data"]["folder"] = manifest.data;
  document["data"]["first_frame"] = manifest.first_frame;
  document["data"]["frames"] = run.camera ? run.camera->deliveries.size() : run.frames.size();
  document["inputs"] = inputs_json(manifest.inputs);
  if (!manifest.recording.is_null()) document["recording"] = manifest.recording;
  document["host"]["seconds"] = run.host_seconds;
  return document;
}

InputDigest digest_of_file(const fs::path& file) {
  return digest_of(file.filename().string(), {file}, base::InputKind::work_trace);
}

std::vector<InputDigest> digest_inputs(const traces::Dataset& data) {
  std::vector<InputDigest> digests;
  for (const traces::InputFiles& input : data.files)
    digests.push_back(digest_of(input.name, input.files, base::InputKind::table));
  std::vector<fs::path> images;
  for (const traces::FrameRef& frame : data.frames) images.push_back(frame.path);
  digests.push_back(
      digest_of(fmt::format("{}, {} images concatenated", data.pictures, images.size()), images,
                base::InputKind::image));
  return digests;
}

}  // namespace leviosim::tools
