// Decodes RV32 from QEMU's disassembly.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "instruction.h"
#include "qemu_plugin.h"

namespace leviosim::rv32 {
namespace {

int register_number(std::string_view name) {
  static const std::map<std::string_view, int> numbers = [] {
    constexpr const char* kNames[64] = {
        "zero", "ra",  "sp",  "gp",   "tp",   "t0",  "t1",  "t2",   "s0",  "s1",  "a0",
        "a1",   "a2",  "a3",  "a4",   "a5",   "a6",  "a7",  "s2",   "s3",  "s4",  "s5",
        "s6",   "s7",  "s8",  "s9",   "s10",  "s11", "t3",  "t4",   "t5",  "t6",  "ft0",
        "ft1",  "ft2", "ft3", "ft4",  "ft5",  "ft6", "ft7", "fs0",  "fs1", "fa0", "fa1",
        "fa2",  "fa3", "fa4", "fa5",  "fa6",  "fa7", "fs2", "fs3",  "fs4", "fs5", "fs6",
        "fs7",  "fs8", "fs9", "fs10", "fs11", "ft8", "ft9", "ft10", "ft11"};
    std::map<std::string_view, int> map;
    for (int i = 0; i < 64; ++i) map[kNames[i]] = i;
    return map;
  }();
  const auto it = numbers.find(name);
  return it == numbers.end() ? -1 : it->second;
}

Kind kind_of(const std::string& m) {
  static const std::map<std::string, Kind> kinds = [] {
    std::map<std::string, Kind> map;
    const auto add = [&](Kind kind, std::initializer_list<const char*> names) {
      for (const char* name : names) map[name] = kind;
    };
    add(Kind::Alu,
        {"add",   "addi", "sub",  "neg",    "and",    "andi",   "or",    "ori",    "xor",  "xori",
         "not",   "sll",  "slli", "srl",    "srli",   "sra",    "srai",  "slt",    "slti", "sltu",
         "sltiu", "seqz", "snez", "sltz",   "sgtz",   "lui",    "auipc", "zext.b", "cpop", "min",
         "max",   "minu", "maxu", "sext.b", "sext.h", "zext.h", "andn",  "orn",    "xnor", "rol",
         "ror",   "rori", "clz",  "ctz",    "rev8",   "orc.b"});
    add(Kind::Move, {"mv", "li", "nop"});
    add(Kind::Mul, {"mul"});
    add(Kind::MulHigh, {"mulh", "mulhu", "mulhsu"});
    add(Kind::Div, {"div", "divu", "rem", "remu"});
    add(Kind::Load, {"lw", "lh", "lhu", "lb", "lbu"});
    add(Kind::Store, {"sw", "sh", "sb"});
    add(Kind::FloatLoad, {"flw"});
    add(Kind::FloatStore, {"fsw"});
    add(Kind::Branch, {"beq", "bne", "blt", "bge", "bltu", "bgeu", "beqz", "bnez", "blez", "bgez",
                       "bltz", "bgtz", "bgt", "ble", "bgtu", "bleu"});
    add(Kind::FloatAdd, {"fadd.s", "fsub.s"});
    add(Kind::FloatMul, {"fmul.s"});
    add(Kind::FloatFma, {"fmadd.s", "fmsub.s", "fnmadd.s", "fnmsub.s"});
    add(Kind::FloatDiv, {"fdiv.s"});
    add(Kind::FloatSqrt, {"fsqrt.s"});
    add(Kind::FloatCompare, {"flt.s", "fle.s", "feq.s", "fgt.s", "fge.s", "fclass.s"});
    add(Kind::FloatConvert, {"fcvt.s.w", "fcvt.s.wu", "fcvt.w.s", "fcvt.wu.s"});
    add(Kind::FloatSign,
        {"fsgnj.s", "fsgnjn.s", "fsgnjx.s", "fabs.s", "fneg.s", "fmin.s", "fmax.s"});
    add(Kind::FloatMove, {"fmv.s", "fmv.w.x", "fmv.x.w", "fmv.s.x", "fmv.x.s"});
    add(Kind::Other,
        {"ecall", "frflags",  "fsflags", "frrm",   "fsrm",  "frcsr",  "fscsr",  "csrr",
         "csrw",  "csrs",     "csrrs",   "csrrw",  "csrrc", "csrrsi", "csrrwi", "csrrci",
         "csrsi", "fsflagsi", "fence",   "ebreak", "unimp", "illegal"});
    return map;
  }();
  const auto it = kinds.find(m);
  if (it == kinds.end()) throw std::runtime_error("unknown instruction " + m);
  return it->second;
}

Instruction::Form form_of(const std::string& mnemonic) {
  using Form = Instruction::Form;
  static const std::map<std::string_view, Form> forms = {
      {"add", Form::Add},        {"addi", Form::AddConstant}, {"sub", Form::Subtract},
      {"mul", Form::Multiply},   {"slli", Form::ShiftLeft},   {"srli", Form::ShiftRight},
      {"srai", Form::ShiftRight}};
  const auto it = forms.find(mnemonic);
  return it == forms.end() ? Form::Other : it->second;
}

/// @param registers  in the order of the text
/// @param numbers    likewise
void set_operands(Instruction& in, const std::string& mnemonic, const std::vector<int>& registers,
                  const std::vector<int>& numbers) {
  const auto reg = [&](std::size_t i) {
    return static_cast<std::int8_t>(i < registers.size() && registers[i] > 0 ? registers[i] : -1);
  };
  const bool stores = in.kind == Kind::Store || in.kind == Kind::FloatStore;
  if (stores || in.loads()) {
    (stores ? in.stored : in.written) = reg(0);
    in.base = reg(1);
    in.offset = numbers.empty() ? 0 : numbers[0];
    return;
  }
  if (in.ends_block()) return;
  in.written = reg(0);
  in.first = reg(1);
  in.second = reg(2);
  in.form = form_of(mnemonic);
  const bool constant = in.form == Instruction::Form::AddConstant ||
                        in.form == Instruction::Form::ShiftLeft ||
                        in.form == Instruction::Form::ShiftRight;
  if (constant && (numbers.empty() || in.first < 0)) in.form = Instruction::Form::Other;
  if (constant && !numbers.empty()) in.constant = numbers[0];
}

/// @param text  "lw a0,12(sp)", after any column of hexadecimal digits
Instruction decoded(std::uint32_t pc, std::size_t size, const std::string& text) {
  Instruction in;
  in.pc = pc;
  in.size = static_cast<std::uint8_t>(size);
  const std::size_t gap = std::min(text.find_first_of(" \t"), text.size());
  const std::string mnemonic = text.substr(0, gap);
  std::vector<int> registers, numbers;
  std::string token;
  std::string rest = text.substr(gap);
  rest = rest.substr(0, rest.find('#')) + ",";
  for (const char c : rest) {
    if (std::strchr(" \t,()", c) == nullptr) {
      token += c;
      continue;
    }
    if (const int r = register_number(token); r >= 0)
      registers.push_back(r);
    else if (!token.empty())
      numbers.push_back(static_cast<int>(std::strtol(token.c_str(), nullptr, 0)));
    token.clear();
  }
  const bool links = !registers.empty() && registers[0] == 1;
  if (mnemonic == "j")
    in.kind = Kind::Jump;
  else if (mnemonic == "jal")
    in.kind = registers.empty() || links ? Kind::Call : Kind::Jump;
  else if (mnemonic == "ret")
    in.kind = Kind::Return;
  else if (mnemonic == "jr")
    in.kind = Kind::IndirectJump;
  else if (mnemonic == "jalr")
    in.kind = registers.size() < 2 || links ? Kind::Call : Kind::IndirectJump;
  else
    in.kind = kind_of(mnemonic);
  set_operands(in, mnemonic, registers, numbers);
  const bool writes = in.kind != Kind::Store && in.kind != Kind::FloatStore && !in.ends_block();
  if (writes && !registers.empty()) {
    if (in.loads() && registers[0] > 0) in.loaded = std::uint64_t{1} << registers[0];
    registers.erase(registers.begin());
  }
  for (const int r : registers) in.reads |= std::uint64_t{1} << r;
  return in;
}

/// Without the column of code in hexadecimal digits that comes first.
std::string disassembly(const qemu_plugin_insn* insn) {
  char* text = qemu_plugin_insn_disas(insn);
  std::string result = text;
  std::free(text);
  const std::size_t digits = result.find_first_not_of("0123456789abcdef");
  if (digits != std::string::npos && digits >= 4 && result[digits] == ' ')
    result = result.substr(result.find_first_not_of(' ', digits));
  return result;
}

}  // namespace

Instruction decode(const qemu_plugin_insn* insn, bool) {
  return decoded(static_cast<std::uint32_t>(qemu_plugin_insn_vaddr(insn)),
                 qemu_plugin_insn_size(insn), disassembly(insn));
}

}  // namespace leviosim::rv32
