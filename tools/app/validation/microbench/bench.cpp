#include "tools/app/validation/microbench/bench.h"

#include <algorithm>

#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kStage = "benchmark";

work::MachineConfig machine_of(const sim::ChipConfig& chip, int workers,
                               const work::CodeMap* code) {
  return {.cores = workers,
          .memory = "L1",
          .capacity = chip.cluster.l1.size,
          .alignment = 4,
          .record = true,
          .code = code};
}

}  // namespace

sim::ChipConfig as_assembly(sim::ChipConfig chip, double loads_used_at_once) {
  for (sim::CoreConfig* core : {&chip.cluster.core, &chip.controller.core}) {
    core->instruction_overhead = 1;
    core->load_use_fraction = loads_used_at_once;
  }
  chip.cluster.fpu.collisions = 0;
  chip.cluster.l1.stream_conflicts = 0;
  return chip;
}

Bench::Bench(const sim::ChipConfig& chip, int cores, const work::CodeMap* code)
    : config_(chip),
      with_master_(cores > chip.cluster.workers),
      workers_(std::min(cores, chip.cluster.workers)),
      machine_(machine_of(chip, workers_, code)) {}

sim::StageTiming Bench::time(const work::Job& job) const {
  sim::Chip chip(config_, workers_);
  sim::JobTiming timing;
  const auto body = [&]() -> sim::Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn(std::string(kStage), body());
  chip.kernel().run();
  return timing.stages.at(0);
}

sim::StageTiming Bench::fork(const std::function<void(work::Core&)>& body) {
  return run([&](work::Machine& machine) {
    if (with_master_)
      machine.fork_with_master("stream", body);
    else
      machine.fork("stream", body);
  });
}

work::Job Bench::record(const std::function<void(work::Machine&)>& body) {
  throw_if_interrupted();
  {
    const auto stage = machine_.stage(kStage);
    body(machine_);
  }
  return machine_.take_job();
}

sim::StageTiming Bench::run(const std::function<void(work::Machine&)>& body) {
  return time(record(body));
}

double Bench::controller_seconds(const std::function<void(work::Machine&)>& body) {
  const work::Job job = record(body);
  sim::Chip chip(config_, workers_);
  sim::JobTiming timing;
  const auto process = [&]() -> sim::Process { timing = co_await chip.control(job); };
  chip.kernel().spawn(std::string(kStage), process());
  chip.kernel().run();
  return static_cast<double>(timing.stages.at(0).cycles.count()) /
         static_cast<double>(config_.controller.clock.count());
}

double Bench::offload_cycles() {
  sim::Chip chip(config_, workers_);
  sim::JobTiming timing;
  const work::Job empty;
  const auto body = [&]() -> sim::Process { timing = co_await chip.offload(empty); };
  chip.kernel().spawn(std::string(kStage), body());
  chip.kernel().run();
  return static_cast<double>(
      chip.controller().clock().whole_cycles(timing.end - timing.begin).count());
}

double stream_cycles(const sim::ChipConfig& chip, int cores, int slots,
                     const std::function<void(work::Core&)>& body) {
  Bench bench(chip, cores);
  const double empty = static_cast<double>(bench.fork([](work::Core&) {}).cycles.count());
  return (static_cast<double>(bench.fork(body).cycles.count()) - empty) / slots;
}

}  // namespace leviosim::tools
