// The kernels that the vendor measured on a GAP8 board (board_programs.h), timed on a chip and
// compared with tools/app/validation/published/gap8_board.csv.
#pragma once

#include <vector>

#include "sim/chip/config.h"
#include "tools/app/validation/microbench/row.h"

namespace leviosim::tools {

/// Times the kernel of every reference: cycles of 100 calls, each with its fork. After them come
/// the speed-ups of eight cores, with a tolerance of 0.5.
/// @param references  as reference_rows() gives them: group is the kernel, name the variant
/// @throws InputError if there is no such kernel
std::vector<MicrobenchRow> board_kernels(const sim::ChipConfig& chip,
                                         std::vector<MicrobenchRow> references);

/// The same with the references and guards that are part of the program.
std::vector<MicrobenchRow> board_rows(const sim::ChipConfig& chip);

}  // namespace leviosim::tools
