// Cuts the trace of executed blocks into named functions and these into pieces.
//
// A piece (f, "") is what f executes from its entry to its first call of a named function or its
// end, a piece (f, g) what it executes from the return of g to the next such call or its end. Code
// of functions without a name belongs to the piece that calls them. Library routines have accounts
// of their own and do not end a piece; the simulator's book-keeping belongs to nobody.
//
// A named function that is compiled as a function of its own begins at its first instruction and
// ends with its return; one that was inlined, at its marks.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "footprint.h"
#include "instruction.h"
#include "traced_program.h"

namespace leviosim::rv32 {

/// Instructions executed one after the other.
struct Block {
  std::vector<Instruction> instructions;
  std::vector<const Mark*> marks;  ///< of each instruction, or nullptr
  bool marked = false;
  const Symbol* symbol = nullptr;
  bool starts_symbol = false;
  bool counts_loop = false;  ///< has a LoopCounter
};

struct LibraryUse {
  std::uint64_t calls = 0, instructions = 0, stalls = 0;
  std::uint64_t fewest = ~std::uint64_t{0}, most = 0;
  std::uint64_t fewest_stalls = ~std::uint64_t{0}, most_stalls = 0;
  std::uint64_t lines = 0;
  std::uint64_t spared = 0;  ///< of the instructions, by Xpulp, with what repeats loops

  LibraryUse& operator+=(const LibraryUse& o) {
    calls += o.calls, instructions += o.instructions, stalls += o.stalls, lines += o.lines;
    spared += o.spared;
    fewest = std::min(fewest, o.fewest), most = std::max(most, o.most);
    fewest_stalls = std::min(fewest_stalls, o.fewest_stalls);
    most_stalls = std::max(most_stalls, o.most_stalls);
    return *this;
  }
  LibraryUse& operator-=(const LibraryUse& o) {
    calls -= o.calls, instructions -= o.instructions, stalls -= o.stalls, lines -= o.lines;
    spared -= o.spared;
    return *this;
  }
};

/// What a function executed itself in a scene.
struct Account {
  std::uint64_t visits = 0;
  std::array<std::uint64_t, kKinds> of_kind{};
  std::uint64_t load_use = 0;
  std::uint64_t load_use_xpulp = 0;  ///< if what Xpulp spares does not stand in between
  std::uint64_t host = 0;            ///< instructions of the simulator's book-keeping
  std::uint64_t inclusive = 0;       ///< instructions from entry to end, with what it called
  std::map<std::string, LibraryUse> library;
};

struct Piece {
  std::uint64_t visits = 0, lines = 0, refetches = 0;
  int most_lines = 0;
};

class Analysis {
 public:
  explicit Analysis(const Program& program) : program_(program) {}

  void execute(const Block& block);
  void write(std::FILE* out) const;

 private:
  struct Frame {
    std::uint32_t back;    ///< address after the call
    const Symbol* symbol;  ///< what runs in it
  };
  struct Named {
    std::string name;
    std::size_t depth;  ///< number of frames
    bool own_frame;     ///< ends with its frame, not with its mark
    bool leaving = false;
    Account* account;
    LineSet* all_lines;
    std::uint64_t began;  ///< instructions executed until its entry
  };

  bool measuring() const { return !named_.empty(); }
  void finish_transfer(const Block& next);
  void enter_function(const Block& block);
  void jump_to(const Block& next);
  void return_to(std::uint32_t pc);
  void begin_library(const Symbol& symbol, bool tail, std::uint32_t back);
  void end_library();
  void count_library(const Block& block);
  void count(const Instruction& in);
  void count_kind(Kind kind);
  void at_mark(const Mark& mark, const Instruction& in);
  void enter_named(const Mark& mark, const Instruction& in);
  void leave_named();
  void settle_prologue();
  void begin_piece(const std::string& function, const std::string& after);
  void end_piece();

  const Program& program_;
  std::vector<Frame> frames_;
  std::vector<Named> named_;
  std::string scene_;
  LineSet* scene_lines_ = nullptr;
  std::uint64_t executed_ = 0;  ///< instructions of kernels and library routines in scenes

  Instruction last_;       ///< executed
  Instruction last_kept_;  ///< … that Xpulp would have, too
  std::uint32_t last_end_ = 0;
  bool last_counts_ = false;  ///< the block before had a LoopCounter
  Account* last_account_ = nullptr;

  /// Instructions since a call, which may turn out to be the first of a named function.
  bool in_prologue_ = false;
  std::vector<Instruction> prologue_;

  // A library routine or host code that is running.
  const Symbol* leaf_ = nullptr;
  std::uint32_t leaf_back_ = 0;
  bool leaf_is_tail_ = false;
  LibraryUse leaf_use_;
  Footprint leaf_lines_;
  std::pair<Account*, LibraryUse> last_copy_{nullptr, {}};

  std::pair<std::string, std::string> piece_key_;
  std::uint64_t piece_instructions_ = 0;
  Footprint footprint_;

  std::map<std::pair<std::string, std::string>, Piece> pieces_;
  std::map<std::pair<std::string, std::string>, Account> accounts_;  ///< by scene and function
  std::map<std::string, LineSet> lines_of_function_;
  std::map<std::string, LineSet> lines_of_scene_;
};

}  // namespace leviosim::rv32
