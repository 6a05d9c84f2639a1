// Decodes ARM and Thumb-2 with the capstone library.
#include <capstone/capstone.h>

#include <array>
#include <map>
#include <stdexcept>
#include <string>

#include "instruction.h"
#include "qemu_plugin.h"

namespace leviosim::rv32 {
namespace {

/// The disassembler of one mode, with room for an instruction.
class Disassembler {
 public:
  explicit Disassembler(cs_mode mode) {
    if (cs_open(CS_ARCH_ARM, mode, &handle_) != CS_ERR_OK)
      throw std::runtime_error("capstone cannot decode ARM");
    cs_option(handle_, CS_OPT_DETAIL, CS_OPT_ON);
    insn_ = cs_malloc(handle_);
  }
  const cs_insn& decode(const qemu_plugin_insn* insn) {
    const auto* code = static_cast<const std::uint8_t*>(qemu_plugin_insn_data(insn));
    std::size_t size = qemu_plugin_insn_size(insn);
    std::uint64_t pc = qemu_plugin_insn_vaddr(insn);
    if (!cs_disasm_iter(handle_, &code, &size, &pc, insn_))
      throw std::runtime_error("unknown instruction");
    return *insn_;
  }
  std::uint64_t reads(const cs_insn& insn) const;

 private:
  csh handle_;
  cs_insn* insn_;
};

/// 0 to 15 integer, 32 to 63 single precision; a double is two of these.
std::uint64_t bits_of(unsigned reg) {
  const auto bit = [](unsigned i) { return std::uint64_t{1} << i; };
  if (reg >= ARM_REG_R0 && reg <= ARM_REG_R12) return bit(reg - ARM_REG_R0);
  if (reg == ARM_REG_SP) return bit(13);
  if (reg == ARM_REG_LR) return bit(14);
  if (reg == ARM_REG_PC) return bit(15);
  if (reg >= ARM_REG_S0 && reg <= ARM_REG_S31) return bit(32 + reg - ARM_REG_S0);
  if (reg >= ARM_REG_D0 && reg <= ARM_REG_D15) return bit(32 + 2 * (reg - ARM_REG_D0)) * 3;
  return 0;
}

std::uint64_t Disassembler::reads(const cs_insn& insn) const {
  cs_regs read, written;
  std::uint8_t read_count = 0, written_count = 0;
  if (cs_regs_access(handle_, &insn, read, &read_count, written, &written_count) != CS_ERR_OK)
    throw std::runtime_error("no registers known of " + std::string(insn.mnemonic));
  std::uint64_t bits = 0;
  for (int i = 0; i < read_count; ++i) bits |= bits_of(read[i]);
  return bits;
}

/// Kinds of instructions that do not depend on their operands; all else is Alu.
const std::map<unsigned, Kind>& kinds() {
  static const std::map<unsigned, Kind> kinds = [] {
    std::map<unsigned, Kind> map;
    const auto add = [&](Kind kind, std::initializer_list<unsigned> ids) {
      for (const unsigned id : ids) map[id] = kind;
    };
    add(Kind::Load,
        {ARM_INS_LDR, ARM_INS_LDRB, ARM_INS_LDRH, ARM_INS_LDRSB, ARM_INS_LDRSH, ARM_INS_LDRD,
         ARM_INS_LDM, ARM_INS_LDMDB, ARM_INS_LDMDA, ARM_INS_LDMIB, ARM_INS_POP});
    add(Kind::Store, {ARM_INS_STR, ARM_INS_STRB, ARM_INS_STRH, ARM_INS_STRD, ARM_INS_STM,
                      ARM_INS_STMDB, ARM_INS_STMDA, ARM_INS_STMIB, ARM_INS_PUSH});
    add(Kind::FloatLoad, {ARM_INS_VLDR, ARM_INS_VLDMIA, ARM_INS_VLDMDB, ARM_INS_VPOP});
    add(Kind::FloatStore, {ARM_INS_VSTR, ARM_INS_VSTMIA, ARM_INS_VSTMDB, ARM_INS_VPUSH});
    add(Kind::Branch, {ARM_INS_CBZ, ARM_INS_CBNZ});
    add(Kind::Jump, {ARM_INS_B});
    add(Kind::Call, {ARM_INS_BL, ARM_INS_BLX});
    add(Kind::IndirectJump, {ARM_INS_BX, ARM_INS_TBB, ARM_INS_TBH});
    add(Kind::Move, {ARM_INS_MOV, ARM_INS_MOVW, ARM_INS_MOVT, ARM_INS_MVN});
    add(Kind::Mul,
        {ARM_INS_MUL, ARM_INS_MLA, ARM_INS_MLS, ARM_INS_SMLABB, ARM_INS_SMLABT, ARM_INS_SMLATB,
         ARM_INS_SMLATT, ARM_INS_SMULBB, ARM_INS_SMULBT, ARM_INS_SMULTB, ARM_INS_SMULTT,
         ARM_INS_SMLAD, ARM_INS_SMUAD, ARM_INS_SMLAWB, ARM_INS_SMULWB, ARM_INS_SMLALBB});
    add(Kind::MulHigh, {ARM_INS_SMULL, ARM_INS_UMULL, ARM_INS_SMLAL, ARM_INS_UMLAL, ARM_INS_UMAAL,
                        ARM_INS_SMMUL, ARM_INS_SMMLA, ARM_INS_SMMLS});
    add(Kind::Div, {ARM_INS_SDIV, ARM_INS_UDIV});
    add(Kind::FloatAdd, {ARM_INS_VADD, ARM_INS_VSUB});
    add(Kind::FloatMul, {ARM_INS_VMUL, ARM_INS_VNMUL});
    add(Kind::FloatFma, {ARM_INS_VMLA, ARM_INS_VMLS, ARM_INS_VNMLA, ARM_INS_VNMLS, ARM_INS_VFMA,
                         ARM_INS_VFMS, ARM_INS_VFNMA, ARM_INS_VFNMS});
    add(Kind::FloatDiv, {ARM_INS_VDIV});
    add(Kind::FloatSqrt, {ARM_INS_VSQRT});
    add(Kind::FloatCompare, {ARM_INS_VCMP, ARM_INS_VCMPE});
    add(Kind::FloatConvert, {ARM_INS_VCVT, ARM_INS_VCVTR});
    add(Kind::FloatSign, {ARM_INS_VABS, ARM_INS_VNEG});
    add(Kind::FloatMove, {ARM_INS_VMOV, ARM_INS_VMRS, ARM_INS_VMSR});
    add(Kind::Other, {ARM_INS_IT, ARM_INS_SVC, ARM_INS_NOP, ARM_INS_HINT, ARM_INS_UDF, ARM_INS_TRAP,
                      ARM_INS_BKPT});
    return map;
  }();
  return kinds;
}

/// Registers that a load or store moves; of several at once, the first operand may be the base.
std::uint64_t moved(const cs_insn& insn) {
  const cs_arm& arm = insn.detail->arm;
  const bool based =
      insn.id == ARM_INS_LDM || insn.id == ARM_INS_LDMDB || insn.id == ARM_INS_LDMDA ||
      insn.id == ARM_INS_LDMIB || insn.id == ARM_INS_STM || insn.id == ARM_INS_STMDB ||
      insn.id == ARM_INS_STMDA || insn.id == ARM_INS_STMIB || insn.id == ARM_INS_VLDMIA ||
      insn.id == ARM_INS_VLDMDB || insn.id == ARM_INS_VSTMIA || insn.id == ARM_INS_VSTMDB;
  std::uint64_t bits = 0;
  for (int i = based ? 1 : 0; i < arm.op_count && arm.operands[i].type == ARM_OP_REG; ++i)
    bits |= bits_of(static_cast<unsigned>(arm.operands[i].reg));
  return bits;
}

bool uses_stack(const cs_insn& insn) {
  const cs_arm& arm = insn.detail->arm;
  return insn.id == ARM_INS_PUSH || insn.id == ARM_INS_POP ||
         (arm.writeback && arm.op_count > 0 && arm.operands[0].type == ARM_OP_REG &&
          arm.operands[0].reg == ARM_REG_SP);
}

bool is_memory(Kind kind) {
  return kind == Kind::Load || kind == Kind::Store || kind == Kind::FloatLoad ||
         kind == Kind::FloatStore;
}

/// Of what writes the program counter: to where it was called from, or elsewhere.
Kind jump_kind(const cs_insn& insn, bool pops) {
  const cs_arm& arm = insn.detail->arm;
  const bool from_link = arm.op_count > 0 && arm.operands[arm.op_count - 1].type == ARM_OP_REG &&
                         arm.operands[arm.op_count - 1].reg == ARM_REG_LR;
  return pops || from_link ? Kind::Return : Kind::IndirectJump;
}

bool writes_pc(const cs_insn& insn) {
  const cs_arm& arm = insn.detail->arm;
  return arm.op_count > 0 && arm.operands[0].type == ARM_OP_REG &&
         arm.operands[0].reg == ARM_REG_PC && insn.id != ARM_INS_CMP;
}

void describe_memory(Instruction& in, const cs_insn& insn) {
  const std::uint64_t registers = moved(insn);
  const int words = __builtin_popcountll(registers);
  in.more_words = static_cast<std::uint8_t>(words > 1 ? words - 1 : 0);
  in.on_stack = uses_stack(insn) && (in.kind == Kind::Load || in.kind == Kind::Store);
  if (!in.loads()) return;
  in.loaded = registers;
  in.reads &= ~registers | bits_of(ARM_REG_SP);
  if ((registers & bits_of(ARM_REG_PC)) == 0) return;
  const cs_arm& arm = insn.detail->arm;
  const bool pops_one = insn.id == ARM_INS_LDR && arm.op_count > 1 &&
                        arm.operands[1].type == ARM_OP_MEM &&
                        arm.operands[1].mem.base == ARM_REG_SP;
  in.on_stack = in.on_stack || pops_one;
  in.kind = jump_kind(insn, in.on_stack);
}

Instruction described(const cs_insn& insn, std::uint64_t reads) {
  Instruction in;
  in.pc = static_cast<std::uint32_t>(insn.address);
  in.size = static_cast<std::uint8_t>(insn.size);
  in.reads = reads;
  const arm_cc condition = insn.detail->arm.cc;
  in.conditional = condition != ARM_CC_AL && condition != ARM_CC_INVALID;
  const auto known = kinds().find(insn.id);
  if (known == kinds().end() && insn.mnemonic[0] == 'v')
    throw std::runtime_error("unknown instruction " + std::string(insn.mnemonic));
  in.kind = known == kinds().end() ? Kind::Alu : known->second;
  if (is_memory(in.kind)) {
    describe_memory(in, insn);
  } else if (insn.id == ARM_INS_BX ||
             ((in.kind == Kind::Move || in.kind == Kind::Alu) && writes_pc(insn))) {
    in.kind = jump_kind(insn, false);
  }
  return in;
}

/// How many instructions follow that this one makes conditional.
int made_conditional(const cs_insn& insn) {
  return insn.id == ARM_INS_IT ? 4 - __builtin_ctz(insn.bytes[0] & 15u) : 0;
}

/// Instructions that an `it` still makes conditional, by where the next of them lies. A block may
/// end between them.
std::map<std::uint32_t, int>& conditional_from() {
  static std::map<std::uint32_t, int> places;
  return places;
}

}  // namespace

Instruction decode(const qemu_plugin_insn* insn, bool is_thumb) {
  static Disassembler arm(CS_MODE_ARM);
  static Disassembler thumb(static_cast<cs_mode>(CS_MODE_THUMB | CS_MODE_MCLASS));
  Disassembler& disassembler = is_thumb ? thumb : arm;
  const cs_insn& decoded = disassembler.decode(insn);
  Instruction in = described(decoded, disassembler.reads(decoded));
  int more = made_conditional(decoded);
  if (const auto it = conditional_from().find(in.pc); it != conditional_from().end()) {
    in.conditional = true;
    more = it->second - 1;
  }
  if (more > 0) conditional_from()[in.pc + in.size] = more;
  if (in.kind == Kind::Jump && in.conditional) in.kind = Kind::Branch;
  return in;
}

}  // namespace leviosim::rv32
