#include "tools/app/validation/microbench/kernel_job.h"

#include "tools/app/run/range_bands.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/microbench_row.h"

namespace leviosim::tools {
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

}  // namespace leviosim::tools
