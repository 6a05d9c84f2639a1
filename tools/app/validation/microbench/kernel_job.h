// Kernels with published cycles: what each does is recorded once and timed on any chip, so also
// with every uncertain number of a platform at both ends of its range.
#pragma once

#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/chip/config.h"
#include "sim/work/program.h"
#include "tools/app/validation/microbench/microbench_row.h"

namespace leviosim::tools {

struct KernelJob {
  MicrobenchRow row{};  ///< with nothing simulated yet
  work::Job job{};
  work::Job left_out{};  ///< whose time is not in the published figure: the fork of one core
  double calls = 1;      ///< number of calls that the figure is of

  double cycles_on(const sim::ChipConfig& chip) const;
};

/// With the bands that the ranges of the platform's numbers leave.
std::vector<MicrobenchRow> banded_rows(const std::vector<KernelJob>& kernels,
                                       const platform::Variants& platform);

/// isa.unmeasured_instructions of the platform with which every kernel of one core would take what
/// is published, but for kernels that mostly wait for something else than instructions. Rising.
std::vector<double> needed_instructions(const std::vector<KernelJob>& kernels,
                                        const platform::Variants& platform);

}  // namespace leviosim::tools
