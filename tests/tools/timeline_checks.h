// Whether a timeline tells the same as the run that it is of: cycles of each stage, and what the
// cores of the team spent them on.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/support/perfetto_reader.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools::testing {

using tests::PerfettoEvent;
using tests::PerfettoTrace;

/// Sums over the slices of a stage, in cycles.
struct SlicesOfStage {
  double cycles = 0;
  std::map<std::string, double> split;  ///< of what the workers worked, by annotation
  double worked = 0;                    ///< by the workers
  double idle = 0;                      ///< of the workers
  double forks = 0;                     ///< from their call to their end
  double synchronisation = 0;
  double serial = 0;
  double transfer = 0;
};

class StageSums {
 public:
  StageSums(const PerfettoTrace& trace, int cores) : trace_(trace) {
    for (const PerfettoEvent& event : trace.on("front end")) {
      if (event.type != PerfettoEvent::kBegin) continue;
      if (event.depth == 0) frames_.push_back({event, {}});
      if (event.depth != 1) continue;
      frames_.back().stages.push_back(event);
      stages_[event.name].cycles += event.number("cycles");
    }
    for (const PerfettoEvent& event : trace.on("controller"))
      if (event.depth == 1) stages_[event.name].cycles += event.number("cycles");
    for (int core = 0; core < cores; ++core) add_worker("core " + std::to_string(core));
    add_master();
  }

  const std::map<std::string, SlicesOfStage>& stages() const { return stages_; }

 private:
  struct Frame {
    PerfettoEvent slice;
    std::vector<PerfettoEvent> stages;
  };

  SlicesOfStage& stage_of(const PerfettoEvent& event) {
    for (const Frame& frame : frames_) {
      if (event.begin_ns < frame.slice.begin_ns || event.end_ns > frame.slice.end_ns) continue;
      for (const PerfettoEvent& stage : frame.stages) {
        const double at = event.number("cycle") - stage.number("cycle");
        if (at >= 0 && at < stage.number("cycles")) return stages_[stage.name];
      }
    }
    ADD_FAILURE() << event.name << " at " << event.begin_ns << " ns lies in no stage";
    return stages_[""];
  }

  void add_worker(const std::string& track) {
    SlicesOfStage* stage = nullptr;
    for (const PerfettoEvent& event : trace_.on(track)) {
      if (event.depth > 0) continue;
      if (event.name == "idle") {
        ASSERT_NE(stage, nullptr);
        stage->idle += event.number("cycles");
        continue;
      }
      stage = &stage_of(event);
      stage->worked += event.number("cycles");
      stage->idle += event.number("idle");
      for (const char* part :
           {"work", "FPU", "divider", "L1 banks", "code", "accelerator", "rounding"})
        stage->split[part] += event.number(part);
    }
  }

  void add_master() {
    for (const PerfettoEvent& event : trace_.on("master")) {
      if (event.depth > 0) continue;
      SlicesOfStage& stage = stage_of(event);
      const double cycles = event.number("cycles");
      stage.synchronisation += event.number("synchronisation");
      stage.serial += event.name == "serial work" ? cycles : event.number("serial");
      const bool is_transfer = event.name == "DMA" || event.name == "waiting for the DMA";
      stage.transfer += is_transfer ? cycles : event.number("transfer");
      if (event.name.rfind("fork: ", 0) == 0) stage.forks += cycles;
      if (event.name == "short steps")
        stage.forks += cycles - event.number("serial") - event.number("transfer");
    }
  }

  const PerfettoTrace& trace_;
  std::vector<Frame> frames_;
  std::map<std::string, SlicesOfStage> stages_;
};

/// All frames of the run are in the trace.
inline void expect_sums_of(const PerfettoTrace& trace, const RunResult& run) {
  const StageSums sums(trace, run.cores);
  const double cores = run.cores;
  for (const StageResult& stage : run.stages) {
    if (stage.calls == 0) continue;
    SCOPED_TRACE(stage.name);
    ASSERT_EQ(sums.stages().count(stage.name), 1u);
    const SlicesOfStage& slices = sums.stages().at(stage.name);
    EXPECT_EQ(slices.cycles, static_cast<double>(stage.parallel.count()));
    if (stage.on_controller) continue;
    const sim::MechanismCycles& breakdown = stage.account.team;
    const double tolerance = 1e-9 * breakdown.total() + 1e-6;
    // Whole cycles: exact.
    EXPECT_EQ(slices.serial * cores, breakdown[sim::Mechanism::Serial]);
    EXPECT_EQ(slices.transfer * cores, breakdown[sim::Mechanism::Transfer]);
    EXPECT_NEAR(slices.synchronisation * cores, breakdown[sim::Mechanism::Synchronisation],
                tolerance);
    EXPECT_NEAR(slices.forks * cores,
                slices.worked + breakdown[sim::Mechanism::Imbalance] +
                    breakdown[sim::Mechanism::Synchronisation],
                tolerance);
    EXPECT_GE(slices.idle, breakdown[sim::Mechanism::Imbalance] - tolerance);
    EXPECT_LE(slices.idle, breakdown[sim::Mechanism::Imbalance] +
                               breakdown[sim::Mechanism::Synchronisation] + tolerance);
    EXPECT_EQ((slices.serial + slices.transfer + slices.forks), slices.cycles);
    const auto part = [&](const char* name) {
      const auto it = slices.split.find(name);
      return it == slices.split.end() ? 0.0 : it->second;
    };
    double worked = 0;
    for (const auto& [name, cycles] : slices.split) worked += cycles;
    EXPECT_NEAR(worked, slices.worked, tolerance);
    EXPECT_NEAR(part("work"),
                breakdown.alone() - breakdown[sim::Mechanism::Fetch] -
                    breakdown[sim::Mechanism::Accelerator],
                tolerance);
    EXPECT_NEAR(part("FPU"), breakdown[sim::Mechanism::Fpu], tolerance);
    EXPECT_NEAR(part("divider"), breakdown[sim::Mechanism::Divider], tolerance);
    EXPECT_NEAR(part("L1 banks"), breakdown[sim::Mechanism::Banks], tolerance);
    EXPECT_NEAR(part("code"),
                breakdown[sim::Mechanism::Fetch] + breakdown[sim::Mechanism::FetchContention],
                tolerance);
    EXPECT_NEAR(
        part("accelerator"),
        breakdown[sim::Mechanism::Accelerator] + breakdown[sim::Mechanism::AcceleratorContention],
        tolerance);
    EXPECT_NEAR(part("rounding"), breakdown[sim::Mechanism::Rounding], tolerance);
  }
}

}  // namespace leviosim::tools::testing
