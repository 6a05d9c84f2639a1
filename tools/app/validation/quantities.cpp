#include "tools/app/validation/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tools/app/result/summary.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/paper_stages.h"

namespace leviosim::tools {
namespace {

using Value = std::optional<double>;

Value ratio(Value a, Value b) {
  if (!a || !b || *b == 0) return std::nullopt;
  return *a / *b;
}

/// Mean of what is given, over the elements that have it.
class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++n_;
  }
  Value value() const { return n_ > 0 ? Value(sum_ / static_cast<double>(n_)) : std::nullopt; }

 private:
  double sum_ = 0;
  std::int64_t n_ = 0;
};

double kilo(Bytes bytes) { return static_cast<double>(bytes.count()) / 1000.0; }

class Quantities {
 public:
  Quantities(const RunResult& run, const FrameLog& log) : run_(run), log_(log) {
    for (const PaperStage& stage : kPaperStages)
      sums_.emplace(stage.key, sum_over(log.frames(), stage));
  }

  std::vector<Quantity> all() {
    add_stages();
    add_imu();
    add_optimiser();
    add_shares();
    add_latencies();
    add_l1();
    add_l2();
    return std::move(list_);
  }

 private:
  void add(std::string name, std::string_view unit, Value value) {
    list_.push_back({std::move(name), std::string(unit), value});
  }
  const StageSum& sum(std::string_view key) const { return sums_.find(key)->second; }
  double ms(Cycles cycles) const {
    return milliseconds(static_cast<double>(cycles.count()), run_.cluster_clock);
  }

  void add_stages() {
    for (const PaperStage& stage : kPaperStages) {
      const StageSum& s = sum(stage.key);
      const std::string path = fmt::format("compute.{}.", stage.key);
      add(path + "single", "kcycles", scaled(s.mean_single(), 1e-3));
      add(path + "multi", "kcycles", scaled(s.mean_parallel(), 1e-3));
      add(path + "speedup", "x", ratio(s.mean_single(), s.mean_parallel()));
    }
  }

  void add_imu() {
    Cycles single;
    Cycles parallel;
    Cycles front_end;
    std::int64_t samples = 0;
    for (const LoggedFrame& frame : log_.frames()) {
      const LoggedStage* stage = frame.find(vio::stages::kImu);
      // Until the first frame is through, samples are only averaged for gravity.
      if (stage == nullptr || frame.result.source == PoseSource::First) continue;
      single += stage->single;
      parallel += stage->parallel;
      samples += stage->calls;
      front_end += frame.result.cycles;
    }
    add("compute.imu_preintegration.per_sample", "kcycles", scaled(mean(single, samples), 1e-3));
    const Value share = ratio(mean(parallel, 1), mean(front_end, 1));
    add("compute.imu_preintegration.share", "%", scaled(share, 100));
  }

  void add_optimiser() {
    Cycles longest;
    std::map<int, Cycles> by_snapshot;
    for (const LoggedIteration& iteration : log_.iterations()) {
      longest = std::max(longest, iteration.cycles);
      by_snapshot[iteration.frame] += iteration.cycles;
    }
    Cycles longest_sum;
    for (const auto& [frame, cycles] : by_snapshot) longest_sum = std::max(longest_sum, cycles);
    const auto ms_of = [&](Cycles cycles) -> Value {
      if (by_snapshot.empty()) return std::nullopt;
      return milliseconds(static_cast<double>(cycles.count()), run_.controller_clock);
    };
    add("compute.optimiser.longest_iteration", "ms", ms_of(longest));
    add("compute.optimiser.longest_frame", "ms", ms_of(longest_sum));
  }

  void add_shares() {
    for (const auto& [name, ransac] :
         {std::pair("epnp", "epnp_ransac"), std::pair("eight_point", "eight_point_ransac")}) {
      Value frame = 0.0;
      for (const std::string_view key :
           {std::string_view("feature_extraction"), std::string_view("frame_matching"),
            std::string_view("world_matching"), std::string_view(ransac)}) {
        const Value part = sum(key).mean_parallel();
        frame = frame && part ? Value(*frame + *part) : std::nullopt;
      }
      add(fmt::format("share.{}", name), "%",
          scaled(ratio(sum(ransac).mean_parallel(), frame), 100));
    }
  }

  void add_latencies() {
    for (const FrameKind& kind : kFrameKinds) {
      Mean time;
      for (const LoggedFrame& frame : log_.frames())
        if (frame.result.source == kind.source && frame.result.keyframe == kind.keyframe &&
            !ran_both(frame))
          time.add(ms(frame.result.cycles));
      add(fmt::format("latency.{}", kind.key), "ms", time.value());
    }
    Mean parallel;
    Mean single;
    for (const LoggedFrame& frame : log_.frames()) {
      if (frame.result.source == PoseSource::First) continue;
      parallel.add(ms(frame.result.cycles));
      single.add(ms(frame.result.single_cycles));
    }
    add("latency.mean", "ms", parallel.value());
    add("latency.single_core", "ms", single.value());
  }

  void add_l1() {
    for (const PaperStage& paper : kPaperStages) {
      const auto stage = std::find_if(run_.stages.begin(), run_.stages.end(),
                                      [&](const StageResult& s) { return s.name == paper.stage; });
      const bool shown = stage != run_.stages.end() && stage->calls > 0;
      for (const auto& [suffix, peak] : {std::pair("single", &work::MemoryPeak::single),
                                         std::pair("parallel", &work::MemoryPeak::parallel)}) {
        const std::optional<Bytes> bytes =
            shown ? std::optional(stage->memory.*peak) : std::nullopt;
        add_memory(paper.key, fmt::format("l1_{}", suffix), fmt::format("occupation_{}", suffix),
                   bytes, run_.l1_size);
      }
    }
  }

  void add_l2() {
    for (const char* name : {"last keyframe", "pose graph", "optimiser"}) {
      const auto row = std::find_if(run_.l2.begin(), run_.l2.end(),
                                    [&](const L2Row& r) { return r.name == name; });
      std::optional<Bytes> bytes;
      if (row != run_.l2.end()) bytes = row->bytes;
      add_memory(key_of(name), "l2", "occupation", bytes, run_.l2_size);
    }
  }

  void add_memory(std::string_view owner, std::string_view kb, std::string_view percent,
                  std::optional<Bytes> bytes, Bytes size) {
    add(fmt::format("memory.{}.{}", owner, kb), "kB", bytes ? Value(kilo(*bytes)) : std::nullopt);
    add(fmt::format("memory.{}.{}", owner, percent), "%",
        bytes ? Value(percent_of_nominal(*bytes, size)) : std::nullopt);
  }

  const RunResult& run_;
  const FrameLog& log_;
  std::map<std::string_view, StageSum> sums_;
  std::vector<Quantity> list_;
};

}  // namespace

bool ran_both(const LoggedFrame& frame) {
  return frame.find(vio::stages::kEpnp) != nullptr &&
         frame.find(vio::stages::kEightPoint) != nullptr;
}

std::vector<Quantity> quantities_of(const RunResult& run, const FrameLog& log) {
  return Quantities(run, log).all();
}

}  // namespace leviosim::tools
