// The kernels that the vendor measured on a GAP8 board (board_programs.h), timed on a chip and
// compared with tools/app/validation/published/gap8_board.csv.
#pragma once

#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/chip/config.h"
#include "tools/app/validation/microbench/kernel_job.h"
#include "tools/app/validation/microbench/microbench_row.h"

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

}  // namespace leviosim::tools
