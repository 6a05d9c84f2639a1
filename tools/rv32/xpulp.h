// What Xpulp spares of code that was compiled for plain RV32, found in straight pieces of executed
// code. No compiler for Xpulp is at hand, so its instructions are recognised by what stands in their
// place (names of CV32E40P's manual, chapters on its extensions to the instruction set):
//   - a pointer that moves besides an access through it: an access with post-increment (cv.lw (a)!);
//   - a sum that only one access has as its address: an access with two registers (cv.lw a(b));
//   - a product that only one sum takes: cv.mac, cv.msu;
//   - a shift to the left and one to the right: cv.extract;
//   - a sum that is shifted to the right, with half of the last place added or not: cv.addN, cv.addRN;
//   - the counter of a loop: cv.setup.
// A register that the rest of the piece does not read is taken to be dead.
//
// Packed integers are compiled as one instruction for an operation (target_xpulp).
//
// Left out: branches with an immediate operand, clipping to powers of two, insertion of bits, and the
// one register file of GAP9 for both kinds of number.
#pragma once

#include <vector>

#include "instruction.h"

namespace leviosim::rv32 {

/// Sets `spared` of the instructions that Xpulp would not have.
/// @param piece  executed one after the other; of RV32
void find_spared(std::vector<Instruction>& piece);

}  // namespace leviosim::rv32
