// Decodes an instruction of the program that is traced. One plugin is built for each decoder.
#pragma once

#include "instruction.h"
#include "qemu_plugin.h"

namespace leviosim::rv32 {

/// Instructions of a block come in order.
/// @param thumb  of ARM: whether it is one of the short ones
/// @throws std::runtime_error if the instruction is not known
Instruction decode(const qemu_plugin_insn* insn, bool thumb);

}  // namespace leviosim::rv32
