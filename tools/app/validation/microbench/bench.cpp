#include "tools/app/validation/microbench/bench.h"

#include <algorithm>

#include "sim/base/interruption.h"
#include "tools/app/run/range_bands.h"
#include "tools/app/validation/references.h"

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

namespace {

constexpr const char* kUnmeasured = "isa.unmeasured_instructions";

}  // namespace

double KernelJob::cycles_on(const sim::ChipConfig& chip) const {
  const Bench bench(chip, row.cores);
  const auto cycles = [&](const work::Job& some) {
    return some.stages.empty() ? 0 : static_cast<double>(bench.time(some).cycles.count());
  };
  return calls * (cycles(job) - cycles(left_out));
}

std::vector<MicrobenchRow> banded_rows(const std::vector<KernelJob>& kernels,
                                       const platform::Variants& platform) {
  const std::vector<Banded> bands = range_bands(platform, [&](const sim::ChipConfig& chip) {
    std::vector<double> cycles;
    for (const KernelJob& kernel : kernels) cycles.push_back(kernel.cycles_on(chip));
    return cycles;
  });
  std::vector<MicrobenchRow> rows;
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    MicrobenchRow& row = rows.emplace_back(kernels[i].row);
    row.simulated = bands[i].value;
    row.band = bands[i];
  }
  return rows;
}

std::vector<double> needed_instructions(const std::vector<KernelJob>& kernels,
                                        const platform::Variants& platform) {
  // A core that runs alone takes a line over their number, but for what its caches miss.
  constexpr double kLess = 0.8;
  constexpr double kMore = 1.6;
  constexpr double kMostlyInstructions = 0.5;  // else what is published says little of them
  const sim::ChipConfig less = platform.config({{kUnmeasured, kLess}});
  const sim::ChipConfig more = platform.config({{kUnmeasured, kMore}});
  std::vector<double> needed;
  for (const KernelJob& kernel : kernels) {
    if (kernel.row.cores != 1) continue;
    const double cycles = kernel.cycles_on(less);
    const double slope = (kernel.cycles_on(more) - cycles) / (kMore - kLess);
    if (slope < kMostlyInstructions * kernel.row.reference) continue;
    needed.push_back(kLess + (kernel.row.reference - cycles) / slope);
  }
  std::sort(needed.begin(), needed.end());
  return needed;
}

namespace {

const std::vector<std::string> kColumns = {"group",     "name",           "cores",     "unit",
                                           "reference", "reference_high", "tolerance", "source"};
const std::vector<std::string> kGuardColumns = {"group", "name",  "cores",
                                                "unit",  "guard", "reason"};

}  // namespace

std::vector<MicrobenchRow> reference_rows(const std::string& file, std::string_view text,
                                          int tier) {
  std::vector<MicrobenchRow> rows;
  for_each_row(file, text, kColumns, [&](const base::CsvRow& row) {
    MicrobenchRow& r = rows.emplace_back();
    r.group = row.text(0);
    r.name = row.text(1);
    r.cores = static_cast<int>(row.number(2));
    r.unit = row.text(3);
    r.reference = row.number(4);
    r.reference_high = row.text(5).empty() ? r.reference : row.number(5);
    r.tolerance = row.number(6);
    r.source = row.text(7);
    r.tier = tier;
  });
  return rows;
}

void take_guards(const std::string& file, std::string_view text, std::vector<MicrobenchRow>& rows) {
  for_each_row(file, text, kGuardColumns, [&](const base::CsvRow& guard) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const MicrobenchRow& r) {
      return r.group == guard.text(0) && r.name.substr(0, r.name.find(',')) == guard.text(1) &&
             r.cores == guard.number(2) && r.unit == guard.text(3);
    });
    if (row == rows.end()) guard.fail(1, "no row of the comparison");
    row->guard = guard.number(4);
    if (!(*row->guard > row->tolerance)) guard.fail(4, "no more than the tolerance of the row");
  });
}

}  // namespace leviosim::tools
