#include "xpulp.h"

#include <algorithm>
#include <cstddef>

namespace leviosim::rv32 {
namespace {

using Form = Instruction::Form;

constexpr int kStackPointer = 2;

std::uint64_t bit(int reg) { return std::uint64_t{1} << reg; }
bool reads(const Instruction& in, int reg) { return (in.reads & bit(reg)) != 0; }
bool writes(const Instruction& in, int reg) { return in.written == reg; }

class Piece {
 public:
  explicit Piece(std::vector<Instruction>& code) : code_(code), absorbs_(code.size()) {}

  void find() {
    for (std::size_t i = 0; i < code_.size(); ++i) {
      const Form form = code_[i].form;
      if (form == Form::AddConstant || form == Form::Add) find_move(i);
      if (form == Form::Add) find_index(i);
      if (form == Form::Multiply) find_sum_of_product(i);
      if (form == Form::ShiftLeft) find_field(i);
      if (form == Form::ShiftRight) find_normalised_sum(i);
    }
    find_loop_counter();
  }

 private:
  /// A pointer that moves: the access lies before, or behind with an offset that takes the step back.
  void find_move(std::size_t i) {
    const Instruction& move = code_[i];
    if (spared(i) || move.written != move.first || move.second == move.first) return;
    if (move.written == kStackPointer) return;
    for (std::size_t k = i; k-- > 0;) {
      if (moves_by(k, i, 0)) return;
      if (hides(code_[k], move.written)) break;
    }
    if (move.form != Form::AddConstant) return;
    for (std::size_t k = i + 1; k < code_.size(); ++k) {
      if (moves_by(k, i, -move.constant)) return;
      if (hides(code_[k], move.written)) break;
    }
  }

  bool moves_by(std::size_t access, std::size_t move, int offset) {
    const Instruction& a = code_[access];
    if (a.base != code_[move].written || a.offset != offset || a.written == a.base) return false;
    return absorb(access, move, Kind::SparedMove);
  }

  /// Other accesses through a pointer only get another offset when its step moves past them.
  static bool hides(const Instruction& in, int pointer) {
    return writes(in, pointer) || (reads(in, pointer) && in.base != pointer);
  }

  void find_index(std::size_t i) {
    if (spared(i)) return;
    const std::size_t k = only_reader(i);
    if (k == code_.size() || code_[k].base != code_[i].written || code_[k].offset != 0) return;
    // It stores the address itself.
    if (code_[k].stored == code_[i].written) return;
    absorb(k, i, Kind::SparedIndex);
  }

  void find_sum_of_product(std::size_t i) {
    const std::size_t k = only_reader(i);
    if (k == code_.size() || spared(k)) return;
    const Instruction& sum = code_[k];
    const int product = code_[i].written;
    const bool adds = sum.form == Form::Add && sum.written == (sum.first == product ? sum.second : sum.first);
    const bool subtracts = sum.form == Form::Subtract && sum.second == product && sum.written == sum.first;
    if (adds || subtracts) absorb(i, k, Kind::SparedSum);
  }

  void find_field(std::size_t i) {
    const std::size_t k = only_reader(i);
    if (k == code_.size() || code_[k].form != Form::ShiftRight) return;
    if (code_[k].constant >= code_[i].constant) absorb(k, i, Kind::SparedShift);
  }

  void find_normalised_sum(std::size_t i) {
    std::size_t k = only_source(i);
    if (k == code_.size() || code_[i].constant < 1) return;
    const int half = 1 << (code_[i].constant - 1);
    const bool rounds = code_[k].form == Form::AddConstant && code_[k].constant == half;
    if (rounds && !spared(k)) {
      absorbs_[i] = true;
      code_[k].spared = Kind::SparedShift;
      k = only_source(k);
      if (k == code_.size()) return;
    } else if (absorbs_[i]) {
      return;
    }
    const bool sums = code_[k].form == Form::Add || code_[k].form == Form::Subtract;
    if (!sums || spared(k) || absorbs_[k]) return;
    absorbs_[i] = true;
    code_[k].spared = Kind::SparedShift;
  }

  /// What counts the iterations of a loop and serves nothing else.
  void find_loop_counter() {
    const Instruction& last = code_.back();
    if (last.kind != Kind::Branch) return;
    for (std::size_t i = code_.size() - 1; i-- > 0;) {
      const Instruction& in = code_[i];
      if (in.form != Form::AddConstant || in.written != in.first || !reads(last, in.written)) continue;
      const auto serves = [&](const Instruction& other) {
        return &other != &in && &other != &last && reads(other, in.written);
      };
      if (!spared(i) && std::none_of(code_.begin(), code_.end(), serves))
        code_[i].spared = Kind::LoopCounter;
      return;
    }
  }

  bool spared(std::size_t i) const { return code_[i].spared != Kind::Other; }

  /// `into` does the work of `what` besides, unless it does another's already.
  bool absorb(std::size_t into, std::size_t what, Kind kind) {
    if (absorbs_[into] || spared(into)) return false;
    absorbs_[into] = true;
    code_[what].spared = kind;
    return true;
  }

  /// The one instruction that reads what `i` writes, or code_.size() if there are none or several.
  std::size_t only_reader(std::size_t i) const {
    const int reg = code_[i].written;
    std::size_t reader = code_.size();
    if (reg <= 0) return reader;
    for (std::size_t k = i + 1; k < code_.size(); ++k) {
      if (reads(code_[k], reg)) {
        if (reader != code_.size()) return code_.size();
        reader = k;
      }
      if (writes(code_[k], reg)) break;
    }
    return reader;
  }

  /// The instruction that made the operand of `i` for nobody else, or code_.size().
  std::size_t only_source(std::size_t i) const {
    for (std::size_t k = i; k-- > 0;)
      if (writes(code_[k], code_[i].first)) return only_reader(k) == i ? k : code_.size();
    return code_.size();
  }

  std::vector<Instruction>& code_;
  std::vector<bool> absorbs_;
};

}  // namespace

void find_spared(std::vector<Instruction>& piece) {
  if (!piece.empty()) Piece(piece).find();
}

}  // namespace leviosim::rv32
