// The kernels that the vendor measured on a GAP8 board (board_programs.h), timed on a chip and
// compared with tools/app/validation/published/gap8_board.csv.
#pragma once

#include <array>
#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/chip/config.h"
#include "tools/app/validation/microbench/bench.h"

namespace leviosim::tools {

/// The kernel of every reference: 100 calls, each with its fork.
/// @param references  as reference_rows() gives them: group is the kernel, name the variant
/// @throws InputError if there is no such kernel
std::vector<KernelJob> board_kernels(const sim::ChipConfig& chip,
                                     std::vector<MicrobenchRow> references);
/// Those that are part of the program.
std::vector<KernelJob> board_kernels(const sim::ChipConfig& chip);

/// Cycles with bands, and after them the speed-ups of eight cores, with a tolerance of 0.5; with
/// the guards that are part of the program.
std::vector<MicrobenchRow> board_rows(const std::vector<KernelJob>& kernels,
                                      const platform::Variants& platform);

// Kernels of a public library for which cycles are published (library_programs.h), timed on a chip
// and compared with tools/app/validation/published/pulp_dsp.csv.

/// What the chip of the figures, a sibling of GAP9, has less of; none of it matters to the kernels.
/// They were scheduled by hand: what compilers add to other code is not in them.
inline constexpr std::array kLibraryChip{"cluster.l1.size=64KiB", "cluster.fpu.units=2",
                                         "isa.instruction_overhead=1", "isa.load_use_fraction=0"};

/// The kernel of every reference. @throws InputError if there is no such kernel
std::vector<KernelJob> library_kernels(const sim::ChipConfig& chip);

}  // namespace leviosim::tools
