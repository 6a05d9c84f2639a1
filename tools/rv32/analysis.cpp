#include "analysis.h"

#include <cstdio>

namespace leviosim::rv32 {
namespace {

constexpr std::size_t kLongestPrologue = 64;

bool is_scene(const std::string& name) { return name.rfind("scene: ", 0) == 0; }

/// Cycles that the pipeline waits besides (platform_models/FORMAT.md); a divisor in the library's
/// long divisions is the upper half of a normalised word, so it has 16 leading zeros.
std::uint64_t stall_of(const Instruction& in) {
  switch (in.kind) {
    case Kind::Jump:
    case Kind::Call:
    case Kind::Return:
    case Kind::IndirectJump:
      return 1;
    case Kind::MulHigh:
      return 4;
    case Kind::Div:
      return 18;
    default:
      return 0;
  }
}

bool uses_loaded(const Instruction& load, const Instruction& next) {
  return (load.loaded & next.reads) != 0;
}

Kind account_of_more_words(const Instruction& in) {
  const bool stores = in.kind == Kind::Store || in.kind == Kind::FloatStore;
  if (in.on_stack) return stores ? Kind::MoreSaved : Kind::MoreRestored;
  return stores ? Kind::MoreStored : Kind::MoreLoaded;
}

std::uint32_t first_line(const Instruction& in) { return in.pc / kLineBytes; }
std::uint32_t last_line(const Instruction& in) { return (in.pc + in.size - 1u) / kLineBytes; }

}  // namespace

void Analysis::execute(const Block& block) {
  finish_transfer(block);
  if (leaf_ != nullptr) {
    count_library(block);
  } else {
    for (std::size_t i = 0; i < block.instructions.size(); ++i) {
      const Instruction& in = block.instructions[i];
      if (block.marks[i] != nullptr) {
        at_mark(*block.marks[i], in);
      } else if (measuring()) {
        if (in_prologue_) {
          prologue_.push_back(in);
          if (in.ends_block() || prologue_.size() > kLongestPrologue) settle_prologue();
        } else {
          count(in);
        }
      }
    }
  }
  last_ = block.instructions.back();
  last_end_ = last_.pc + last_.size;
  last_counts_ = block.counts_loop;
}

/// What the last instruction of the block before did, now that its target is known.
void Analysis::finish_transfer(const Block& next) {
  const std::uint32_t pc = next.instructions.front().pc;
  if (leaf_ != nullptr) {
    if (last_.kind == Kind::Branch && pc != last_end_) leaf_use_.stalls += 2;
    if (last_.kind == Kind::Branch && pc < last_.pc) leaf_use_.spared += last_counts_ ? 2 : 1;
    if (pc != leaf_back_) return;
    end_library();
    if (leaf_is_tail_) return_to(pc);
    return;
  }
  if (last_.conditional && last_.kind != Kind::Branch && pc == last_end_) return;  // skipped
  switch (last_.kind) {
    case Kind::Branch:
      if (pc != last_end_) count_kind(Kind::BranchTaken);
      if (pc < last_.pc) {
        count_kind(Kind::BranchBack);
        if (last_counts_) count_kind(Kind::LoopCounter);
      }
      if (last_.conditional && pc != last_end_) jump_to(next);
      break;
    case Kind::Call:
      if (next.symbol != nullptr && next.symbol->role != Role::Kernel)
        return begin_library(*next.symbol, false, last_end_);
      frames_.push_back({last_end_, next.symbol});
      in_prologue_ = true;
      break;
    case Kind::Jump:
    case Kind::IndirectJump:
      jump_to(next);
      break;
    case Kind::Return:
      return_to(pc);
      break;
    default:
      break;
  }
}

/// A jump to another function is a call in the place of the return.
void Analysis::jump_to(const Block& next) {
  if (!next.starts_symbol || frames_.empty() || next.symbol == frames_.back().symbol) return;
  settle_prologue();
  if (next.symbol->role != Role::Kernel)
    return begin_library(*next.symbol, true, frames_.back().back);
  // A call in the place of the return.
  while (measuring() && named_.back().own_frame && named_.back().leaving &&
         named_.back().depth == frames_.size())
    leave_named();
  frames_.back().symbol = next.symbol;
  in_prologue_ = true;
}

void Analysis::return_to(std::uint32_t pc) {
  settle_prologue();
  while (!frames_.empty()) {
    const bool there = frames_.back().back == pc;
    frames_.pop_back();
    while (measuring() && named_.back().depth > frames_.size()) leave_named();
    if (there) break;
  }
}

void Analysis::begin_library(const Symbol& symbol, bool tail, std::uint32_t back) {
  leaf_ = &symbol;
  leaf_is_tail_ = tail;
  leaf_back_ = back;
  leaf_use_ = {};
  leaf_lines_.start();
  if (symbol.name.find("note_transfer") != std::string::npos && last_copy_.first != nullptr) {
    // That copy was done by the DMA.
    LibraryUse& use = last_copy_.first->library["memcpy"];
    use -= last_copy_.second;
    last_copy_.first->host += last_copy_.second.instructions;
    executed_ -= last_copy_.second.instructions;
  }
  last_copy_.first = nullptr;
}

void Analysis::count_library(const Block& block) {
  const bool library = leaf_->role == Role::Library;
  for (const Instruction& in : block.instructions) {
    leaf_use_.instructions += 1;
    if (in.spared != Kind::Other && in.spared != Kind::LoopCounter) leaf_use_.spared += 1;
    if (!library) continue;
    leaf_use_.stalls += stall_of(in) + (uses_loaded(last_, in) ? 1 : 0);
    for (std::uint32_t line = first_line(in); line <= last_line(in); ++line) {
      leaf_lines_.touch(line);
      if (measuring()) scene_lines_->add(line);
    }
    last_ = in;
  }
}

void Analysis::end_library() {
  const Symbol& symbol = *leaf_;
  leaf_ = nullptr;
  if (!measuring()) return;
  Account& account = *named_.back().account;
  if (symbol.role == Role::Host) {
    account.host += leaf_use_.instructions;
    return;
  }
  LibraryUse& use = account.library[symbol.name];
  leaf_use_.calls = 1;
  leaf_use_.fewest = leaf_use_.most = leaf_use_.instructions;
  leaf_use_.fewest_stalls = leaf_use_.most_stalls = leaf_use_.stalls;
  leaf_use_.lines = static_cast<std::uint64_t>(leaf_lines_.distinct());
  executed_ += leaf_use_.instructions;
  use += leaf_use_;
  if (symbol.name == "memcpy") last_copy_ = {&account, leaf_use_};
}

void Analysis::count_kind(Kind kind) {
  if (last_account_ != nullptr) ++last_account_->of_kind[static_cast<std::size_t>(kind)];
}

void Analysis::count(const Instruction& in) {
  Named& top = named_.back();
  ++top.account->of_kind[static_cast<std::size_t>(in.kind)];
  if (in.more_words > 0)
    top.account->of_kind[static_cast<std::size_t>(account_of_more_words(in))] += in.more_words;
  if (in.spared != Kind::Other && in.spared != Kind::LoopCounter)
    ++top.account->of_kind[static_cast<std::size_t>(in.spared)];
  ++executed_;
  if (uses_loaded(last_, in)) ++top.account->load_use;
  if (in.spared == Kind::Other) {
    if (uses_loaded(last_kept_, in)) ++top.account->load_use_xpulp;
    last_kept_ = in;
  }
  last_account_ = top.account;
  last_ = in;
  ++piece_instructions_;
  for (std::uint32_t line = first_line(in); line <= last_line(in); ++line) {
    footprint_.touch(line);
    top.all_lines->add(line);
    scene_lines_->add(line);
  }
}

void Analysis::settle_prologue() {
  in_prologue_ = false;
  if (measuring())
    for (const Instruction& in : prologue_) count(in);
  prologue_.clear();
}

void Analysis::at_mark(const Mark& mark, const Instruction& in) {
  if (mark.entry) {
    enter_named(mark, in);
    return;
  }
  settle_prologue();
  while (measuring() && named_.back().leaving) leave_named();
  if (!measuring()) return;
  if (named_.back().own_frame)
    named_.back().leaving = true;
  else
    leave_named();
}

void Analysis::enter_named(const Mark& mark, const Instruction& in) {
  if (!measuring() && !is_scene(mark.name)) return;  // preparation of a scene
  const bool own = !is_scene(mark.name) && in_prologue_ && !frames_.empty() &&
                   frames_.back().symbol != nullptr && in.pc >= frames_.back().symbol->begin &&
                   in.pc < frames_.back().symbol->end &&
                   frames_.back().symbol->function == mark.source;
  std::vector<Instruction> first;
  if (own) first.swap(prologue_);
  settle_prologue();
  if (is_scene(mark.name)) {
    scene_ = mark.name;
    scene_lines_ = &lines_of_scene_[scene_];
    last_account_ = nullptr;
  }
  if (measuring()) end_piece();
  Account& account = accounts_[{scene_, mark.name}];
  ++account.visits;
  named_.push_back(
      {mark.name, frames_.size(), own, false, &account, &lines_of_function_[mark.name], executed_});
  begin_piece(mark.name, "");
  for (const Instruction& i : first) count(i);
}

void Analysis::leave_named() {
  end_piece();
  named_.back().account->inclusive += executed_ - named_.back().began;
  const std::string left = named_.back().name;
  named_.pop_back();
  if (measuring())
    begin_piece(named_.back().name, left);
  else
    last_account_ = nullptr;
}

void Analysis::begin_piece(const std::string& function, const std::string& after) {
  piece_key_ = {function, after};
  piece_instructions_ = 0;
  footprint_.start();
}

void Analysis::end_piece() {
  Piece& piece = pieces_[piece_key_];
  ++piece.visits;
  piece.lines += static_cast<std::uint64_t>(footprint_.distinct());
  piece.refetches += static_cast<std::uint64_t>(footprint_.refetches());
  piece.most_lines = std::max(piece.most_lines, footprint_.distinct());
}

void Analysis::write(std::FILE* out) const {
  for (const auto& [key, p] : pieces_)
    std::fprintf(out, "piece\t%s\t%s\t%llu\t%llu\t%llu\t%d\n", key.first.c_str(),
                 key.second.c_str(), static_cast<unsigned long long>(p.visits),
                 static_cast<unsigned long long>(p.lines),
                 static_cast<unsigned long long>(p.refetches), p.most_lines);
  for (const auto& [key, a] : accounts_) {
    std::fprintf(out, "account\t%s\t%s\tvisits\t%llu\n", key.first.c_str(), key.second.c_str(),
                 static_cast<unsigned long long>(a.visits));
    const auto put = [&](const char* what, std::uint64_t n) {
      if (n > 0)
        std::fprintf(out, "account\t%s\t%s\t%s\t%llu\n", key.first.c_str(), key.second.c_str(),
                     what, static_cast<unsigned long long>(n));
    };
    for (std::size_t k = 0; k < kKinds; ++k) put(kKindNames[k], a.of_kind[k]);
    put("load_use", a.load_use);
    put("load_use_xpulp", a.load_use_xpulp);
    put("host", a.host);
    put("inclusive", a.inclusive);
    for (const auto& [name, use] : a.library) {
      std::fprintf(out, "spared\t%s\t%s\t%s\t%llu\n", key.first.c_str(), key.second.c_str(),
                   name.c_str(), static_cast<unsigned long long>(use.spared));
      std::fprintf(out, "library\t%s\t%s\t%s\t%llu\t%llu\t%llu\t%llu\t%llu\t%llu\t%llu\t%llu\n",
                   key.first.c_str(), key.second.c_str(), name.c_str(),
                   static_cast<unsigned long long>(use.calls),
                   static_cast<unsigned long long>(use.instructions),
                   static_cast<unsigned long long>(use.fewest),
                   static_cast<unsigned long long>(use.most),
                   static_cast<unsigned long long>(use.stalls),
                   static_cast<unsigned long long>(use.fewest_stalls),
                   static_cast<unsigned long long>(use.most_stalls),
                   static_cast<unsigned long long>(use.lines));
    }
  }
  for (const auto& [name, lines] : lines_of_function_)
    std::fprintf(out, "function\t%s\t%d\n", name.c_str(), lines.count());
  for (const auto& [name, lines] : lines_of_scene_)
    std::fprintf(out, "scene\t%s\t%d\n", name.c_str(), lines.count());
}

}  // namespace leviosim::rv32
