#include "tools/app/run/run_folder.h"

#include <fmt/format.h>

#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy.h"
#include "tools/app/result/summary.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {
namespace {

/// Cells of one line, in order. Text cells are our own names and hold neither commas nor quotes.
class CsvLine {
 public:
  CsvLine& add(std::string_view cell) {
    cells_.emplace_back(cell);
    return *this;
  }
  CsvLine& add(std::int64_t value) { return add(fmt::format("{}", value)); }
  CsvLine& add(Cycles value) { return add(value.count()); }
  CsvLine& add(Bytes value) { return add(value.count()); }
  CsvLine& add(double value) { return add(fmt::format("{:.3f}", value)); }
  CsvLine& add(std::optional<double> value) {
    return value ? add(*value) : add(std::string_view());
  }
  std::string str() const { return fmt::format("{}\n", fmt::join(cells_, ",")); }

 private:
  std::vector<std::string> cells_;
};

std::string stages_header(const RunResult& run) {
  CsvLine line;
  for (const char* name :
       {"stage", "call", "runs_on", "calls", "single_cycles", "parallel_cycles",
        "single_cycles_per_call", "parallel_cycles_per_call", "worst_parallel_cycles", "speedup",
        "parallel_ms_per_call", "memory_single_bytes", "memory_parallel_bytes"})
    line.add(std::string_view(name));
  for (const AccountPart& part : account_parts(run))
    line.add(fmt::format("{}_core_cycles", part.key));
  for (const work::OpInfo& op : work::kOps) line.add(fmt::format("{}_ops", op.name));
  return line.str();
}

std::string stage_line(const RunResult& run, const StageResult& stage) {
  const std::optional<double> parallel = mean(stage.parallel, stage.calls);
  std::optional<double> ms;
  if (parallel) ms = milliseconds(*parallel, clock_of(run, stage));
  CsvLine line;
  line.add(stage.name).add(stage.unit).add(stage.on_controller ? "controller" : "cluster");
  line.add(stage.calls).add(stage.single).add(stage.parallel);
  line.add(mean(stage.single, stage.calls)).add(parallel).add(stage.worst_parallel);
  line.add(speedup(stage)).add(ms).add(stage.memory.single).add(stage.memory.parallel);
  for (const AccountPart& part : account_parts(run)) line.add(part.of(stage.account));
  for (const work::OpInfo& op : work::kOps)
    line.add(static_cast<std::int64_t>(stage.counts[op.op]));
  return line.str();
}

/// A peak of a memory and the blocks alive at it.
std::string memory_lines(std::string_view memory, Bytes size, std::string_view owner,
                         std::string_view peak, Bytes bytes,
                         const std::vector<work::Block>& blocks) {
  const auto line = [&](std::string_view what, std::string_view name, int copies, Bytes amount) {
    return CsvLine()
        .add(memory)
        .add(owner)
        .add(what)
        .add(name)
        .add(std::int64_t{copies})
        .add(amount)
        .add(percent_of_nominal(amount, size))
        .str();
  };
  std::string text = line(peak, "", 1, bytes);
  for (const BlockGroup& group : grouped(blocks))
    text += line("block", group.name, group.copies, group.bytes);
  return text;
}

/// One quantity of a row, in all domains and in total. @param scale  from joules to its unit
std::string energy_lines(std::string_view stage, std::string_view quantity, std::string_view unit,
                         double scale, const sim::DomainEnergies& energies) {
  const auto line = [&](std::string_view domain, const sim::Estimate<Joules>& e) {
    const auto figure = [&](Joules joules) {
      return fmt::format("{:.6f}", joules.count() * scale);
    };
    return CsvLine()
        .add(stage)
        .add(quantity)
        .add(domain)
        .add(figure(e.value))
        .add(unit)
        .add(figure(e.low()))
        .add(figure(e.high()))
        .str();
  };
  std::string text;
  for (const sim::DomainInfo& info : sim::kDomains) text += line(info.name, energies[info.domain]);
  return text + line("total", energies.total());
}

std::string energy_lines(const EnergyRow& row) {
  std::string text = energy_lines(row.name, "energy", "mJ", 1e3, row.energy);
  if (row.calls > 0)
    text += energy_lines(row.name, fmt::format("energy per {}", row.unit), "uJ",
                         1e6 / static_cast<double>(row.calls), row.energy);
  if (row.time > Seconds(0))
    text += energy_lines(row.name, "power", "mW", 1e3 / row.time.count(), row.energy);
  return text;
}

CsvLine frame_line(const RunResult& run, const FrameResult& frame) {
  CsvLine line;
  line.add(std::int64_t{frame.index}).add(frame.t_ns).add(key_of(frame.source));
  for (const int value : {int{frame.keyframe}, frame.features, frame.world_matches,
                          frame.frame_matches, frame.inliers, frame.landmarks})
    line.add(std::int64_t{value});
  if (run.timed)
    line.add(frame.arrival_ns)
        .add(frame.start_ns)
        .add(frame.end_ns)
        .add(frame.end_ns - frame.arrival_ns)
        .add(frame.cycles)
        .add(frame.single_cycles);
  return line;
}

/// A frame that was never processed: all cells but frame, stamp and arrival are empty.
CsvLine dropped_line(const soc::Delivery& delivery) {
  constexpr int kOfTheImage = 7;
  constexpr int kOfTheTiming = 5;
  CsvLine line;
  line.add(std::int64_t{delivery.frame}).add(delivery.t_ns);
  for (int i = 0; i < kOfTheImage; ++i) line.add(std::string_view());
  line.add(delivery.arrival_ns);
  for (int i = 0; i < kOfTheTiming; ++i) line.add(std::string_view());
  return line;
}

/// Of a closed loop: all frames of the camera, dropped or not.
std::string delivery_lines(const RunResult& run) {
  std::string text;
  auto frame = run.frames.begin();
  for (const soc::Delivery& delivery : run.camera->deliveries) {
    const bool missed = delivery.dropped || is_late(*frame, run);
    CsvLine line = delivery.dropped ? dropped_line(delivery) : frame_line(run, *frame++);
    line.add(std::int64_t{delivery.found})
        .add(std::int64_t{delivery.dropped})
        .add(std::int64_t{missed});
    text += line.str();
  }
  return text;
}

}  // namespace

std::string stages_csv(const RunResult& run) {
  std::string text = stages_header(run);
  for (const StageResult& stage : run.stages) text += stage_line(run, stage);
  return text;
}

std::string frames_csv(const RunResult& run) {
  std::string text =
      "frame,t_ns,source,keyframe,features,world_matches,frame_matches,inliers,landmarks";
  if (run.timed) text += ",arrival_ns,start_ns,end_ns,latency_ns,parallel_cycles,single_cycles";
  if (run.camera) return text + ",found_in_buffers,dropped,missed\n" + delivery_lines(run);
  text += '\n';
  for (const FrameResult& frame : run.frames) text += frame_line(run, frame).str();
  return text;
}

std::string memory_csv(const RunResult& run) {
  std::string text = "memory,owner,what,block,copies,bytes,percent_of_nominal\n";
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller) continue;  // it is one of the rows of L2
    text +=
        memory_lines("L1", run.l1_size, stage.name, "peak on one core", stage.memory.single, {});
    text += memory_lines("L1", run.l1_size, stage.name, "peak on N cores", stage.memory.parallel,
                         stage.memory.blocks);
  }
  for (const L2Row& row : run.l2)
    text += memory_lines("L2", run.l2_size, row.name, "peak", row.bytes, row.blocks);
  return text;
}

std::string energy_csv(const RunResult& run) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return {};
  std::string text = "stage,quantity,domain,value,unit,low,high\n";
  for (const EnergyRow& row : energy->rows) text += energy_lines(row);
  return text +
         energy_lines({"all", "frame", false, energy->frames, energy->time, energy->total()});
}

void write_run_folder(base::OutputFolder& out, const RunResult& run, const Manifest& manifest,
                      const std::string& platform_yaml, const std::string& below) {
  const auto write = [&](const char* name, const std::string& text) {
    out.write(below + name, text);
  };
  write("manifest.json", json_text(manifest_json(manifest, run), 2) + '\n');
  write("stats.json", statistics_text(run));
  write("frames.csv", frames_csv(run));
  write("trajectory.tum", traces::format_tum(run.trajectory));
  if (!run.timed) return;
  write("platform.yaml", platform_yaml);
  write("stages.csv", stages_csv(run));
  write("memory.csv", memory_csv(run));
  if (const std::string energy = energy_csv(run); !energy.empty()) write("energy.csv", energy);
}

}  // namespace leviosim::tools
