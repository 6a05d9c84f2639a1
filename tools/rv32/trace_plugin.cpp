// Plugin for qemu-riscv32 and qemu-arm: hands every executed block of the program to the analysis,
// in order and without sampling. Arguments: program=ELF file,out=file for the results.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "analysis.h"
#include "instruction.h"
#include "qemu_plugin.h"
#include "xpulp.h"

extern "C" {
__attribute__((visibility("default"))) int qemu_plugin_version = 1;
}

namespace leviosim::rv32 {
namespace {

struct Session {
  Session(const std::string& path, std::string result_path)
      : program(path), analysis(program), out(std::move(result_path)) {}

  Program program;
  Analysis analysis;
  std::string out;
  std::vector<std::unique_ptr<Block>> blocks;
};

/// QEMU's callbacks carry no data of ours when a block is translated.
Session* session = nullptr;

void execute(unsigned, void* data) { session->analysis.execute(*static_cast<Block*>(data)); }

void translate(qemu_plugin_id_t, qemu_plugin_tb* translated) {
  auto block = std::make_unique<Block>();
  for (std::size_t i = 0; i < qemu_plugin_tb_n_insns(translated); ++i) {
    const qemu_plugin_insn* insn = qemu_plugin_tb_get_insn(translated, i);
    const auto pc = static_cast<std::uint32_t>(qemu_plugin_insn_vaddr(insn));
    const Mark* mark = session->program.mark_at(pc);
    Instruction decoded;
    decoded.pc = pc;
    decoded.size = static_cast<std::uint8_t>(qemu_plugin_insn_size(insn));
    try {
      if (mark == nullptr) decoded = decode(insn, session->program.thumb_at(pc));
    } catch (const std::exception& error) {
      std::fprintf(stderr, "trace_plugin: %s at %x\n", error.what(), pc);
      std::exit(1);
    }
    block->instructions.push_back(decoded);
    block->marks.push_back(mark);
  }
  find_spared(block->instructions);
  block->counts_loop = std::any_of(block->instructions.begin(), block->instructions.end(),
                                   [](const auto& in) { return in.spared == Kind::LoopCounter; });
  const std::uint32_t begin = block->instructions.front().pc;
  block->symbol = session->program.symbol_at(begin);
  block->starts_symbol = block->symbol != nullptr && block->symbol->begin == begin;
  qemu_plugin_register_vcpu_tb_exec_cb(translated, execute, 0, block.get());
  session->blocks.push_back(std::move(block));
}

void finish(qemu_plugin_id_t, void*) {
  std::FILE* out = std::fopen(session->out.c_str(), "w");
  if (out == nullptr) {
    std::fprintf(stderr, "trace_plugin: cannot write %s\n", session->out.c_str());
    std::exit(1);
  }
  session->analysis.write(out);
  std::fclose(out);
}

}  // namespace
}  // namespace leviosim::rv32

extern "C" __attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id,
                                                                          const qemu_info_t*,
                                                                          int argc, char** argv) {
  using namespace leviosim::rv32;
  std::string program, out;
  for (int i = 0; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind("program=", 0) == 0) program = argument.substr(8);
    if (argument.rfind("out=", 0) == 0) out = argument.substr(4);
  }
  try {
    session = new Session(program, out);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trace_plugin: %s\n", error.what());
    return 1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
  qemu_plugin_register_atexit_cb(id, finish, nullptr);
  return 0;
}
