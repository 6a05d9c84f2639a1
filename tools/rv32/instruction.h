// One executed instruction of any instruction set: what kind it is, which registers it reads and
// loads; of RV32 also its operands, from which xpulp.h finds what Xpulp spares.
#pragma once

#include <array>
#include <cstdint>

struct qemu_plugin_insn;

namespace leviosim::rv32 {

enum class Kind : std::uint8_t {
  Alu,
  Move,
  Mul,
  MulHigh,
  Div,
  Load,
  Store,
  FloatLoad,
  FloatStore,
  Branch,
  Jump,
  Call,
  Return,
  IndirectJump,
  FloatAdd,
  FloatMul,
  FloatFma,
  FloatDiv,
  FloatSqrt,
  FloatCompare,
  FloatConvert,
  FloatSign,
  FloatMove,
  Other,
  BranchTaken,  ///< only as an account: of Branch, those that were taken
  BranchBack,   ///< … of them, those to an earlier place: they repeat loops
  // Only as accounts, too: words beyond the first that an instruction moves.
  MoreLoaded,
  MoreStored,
  MoreRestored,  ///< integer registers from the stack, at the end of a function
  MoreSaved,     ///< … to the stack
  // Likewise: instructions that Xpulp would not have (xpulp.h).
  SparedMove,   ///< of a pointer, besides an access through it
  SparedIndex,  ///< the sum of an address
  SparedSum,    ///< with a product
  SparedShift,  ///< before or after another shift or a sum
  LoopCounter,  ///< of loops that were repeated
};
inline constexpr std::array kKindNames = {
    "alu",          "move",          "mul",         "mul_high",     "div",           "load",
    "store",        "float_load",    "float_store", "branch",       "jump",          "call",
    "return",       "indirect_jump", "f32_add",     "f32_mul",      "f32_fma",       "f32_div",
    "f32_sqrt",     "f32_compare",   "f32_convert", "f32_sign",     "f32_move",      "other",
    "branch_taken", "branch_back",   "more_loaded", "more_stored",  "more_restored", "more_saved",
    "spared_move",  "spared_index",  "spared_sum",  "spared_shift", "loop_counter"};
inline constexpr std::size_t kKinds = kKindNames.size();

struct Instruction {
  std::uint32_t pc = 0;
  std::uint8_t size = 0;
  Kind kind = Kind::Other;
  bool conditional = false;     ///< may be skipped; of branches, may also leave the function
  std::uint8_t more_words = 0;  ///< that it moves beyond the first
  bool on_stack = false;        ///< saves or restores integer registers
  std::uint64_t loaded = 0;     ///< registers that a load fills: 0 to 31 integer, 32 to 63 float
  std::uint64_t reads = 0;      ///< registers, likewise

  // Of RV32 only. Registers are numbered as above; -1: none.
  enum class Form : std::uint8_t {
    Other,
    Add,
    AddConstant,
    Subtract,
    Multiply,
    ShiftLeft,
    ShiftRight
  };
  Form form = Form::Other;
  std::int8_t written = -1, first = -1, second = -1;  ///< result and operands
  std::int8_t base = -1;                              ///< register of an access's address
  std::int8_t stored = -1;                            ///< by a store
  std::int32_t offset = 0;                            ///< of an access
  std::int32_t constant = 0;                          ///< operand of a form
  Kind spared = Kind::Other;                          ///< if Xpulp would not have it, why

  bool ends_block() const { return kind >= Kind::Branch && kind <= Kind::IndirectJump; }
  bool loads() const { return kind == Kind::Load || kind == Kind::FloatLoad; }
};

/// Decodes an instruction of the program that is traced. One plugin is built for each decoder.
/// Instructions of a block come in order.
/// @param thumb  of ARM: whether it is one of the short ones
/// @throws std::runtime_error if the instruction is not known
Instruction decode(const qemu_plugin_insn* insn, bool thumb);

}  // namespace leviosim::rv32
