// Kernels of a public library for which cycles are published (library_programs.h), timed on a chip
// and compared with tools/app/validation/published/pulp_dsp.csv.
#pragma once

#include <array>
#include <vector>

#include "sim/chip/config.h"
#include "tools/app/validation/microbench/kernel_job.h"

namespace leviosim::tools {

/// What the chip of the figures, a sibling of GAP9, has less of; none of it matters to the kernels.
/// They were scheduled by hand.
inline constexpr std::array kLibraryChip{"cluster.l1.size=64KiB", "cluster.fpu.units=2",
                                         "isa.load_use_fraction=0"};

/// The kernel of every reference. @throws InputError if there is no such kernel
std::vector<KernelJob> library_kernels(const sim::ChipConfig& chip);

}  // namespace leviosim::tools
